// The page: what its data are decides what it shows.
import "./style.css";
import { readPage } from "./data.js";
import { make, number } from "./dom.js";
import { Inspector } from "./inspect.js";
import { Overlays } from "./overlays.js";
import { Player } from "./player.js";
import { Plot } from "./plots.js";
import { Recording } from "./recording.js";
import { Robot } from "./robot.js";
import { Scene } from "./scene.js";
import { addTables } from "./tables.js";
import { addTools } from "./tools.js";

const byId = (id) => document.getElementById(id);
const OPEN = ["contact forces", "energy", "q"];

function heading(head) {
  const { model } = head;
  document.title = `${model.name} · dyn`;
  byId("header").append(make("b", {}, model.name), make("span", {}, `${model.joints.length - 1} joints, nq ${model.nq}, nv ${model.nv}, ${number(model.mass)} kg`), make("span", {}, `libdyn ${head.version}`));
}

function start({ head, read }) {
  heading(head);
  const robot = new Robot(head.model, read);
  const recording = new Recording(head.recording, head.model, read);
  const first = recording.at(recording.start);
  robot.setPoses(first.positions, first.turns);
  const scene = new Scene(byId("canvas"), robot);
  scene.settle();
  const overlays = new Overlays(robot, scene);
  addTools(byId("tools"), { robot, scene, overlays });
  const inspector = new Inspector(byId("link"), robot, scene);
  const side = byId("side");

  const moving = recording.moments > 1;
  const contacts = moving && recording.contactPlot();
  const plots = moving ? [contacts, ...recording.plots].filter(Boolean).map((plot) => new Plot({ ...plot, open: OPEN.includes(plot.title) }, recording.time, (t) => player.seek(t))) : [];
  const show = (t) => {
    const now = recording.at(t), k = recording.index(t);
    robot.setPoses(now.positions, now.turns);
    overlays.setCom(...now.com);
    scene.track(overlays.com.position);
    const touching = recording.contactsAt(k);
    overlays.setContacts(touching);
    for (const plot of plots) plot.mark(t);
    inspector.state = { k, contacts: touching };
    scene.redraw();
  };
  // what is text follows ten times a second
  const state = () => {
    const k = recording.index(player?.time ?? recording.start);
    const row = (title) => {
      const plot = recording.plots.find((p) => p.title === title);
      return plot?.values.subarray(k * plot.names.length, (k + 1) * plot.names.length);
    };
    inspector.show({ q: row("q"), v: row("v"), tau: row("tau"), contacts: recording.contactsAt(k) });
    for (const plot of plots) plot.values(k);
  };

  const player = moving ? new Player(byId("player"), recording, show) : null;
  for (const plot of plots) side.append(plot.box), plot.once();
  addTables(side, head);
  if (player) player.seek(recording.start);
  else show(recording.start);
  state();
  let before = performance.now(), told = 0;
  const frame = (now) => {
    player?.tick((now - before) / 1000);
    before = now;
    if (player?.playing ? now - told > 100 : player && player.time !== state.time) (told = now), (state.time = player.time), state();
    scene.draw();
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  if (player && head.play !== false) player.play(true);
  window.dynView = { robot, scene, player, recording, inspector, plots }; // for the console, and for tests
}

const page = readPage();
if (page) start(page);
else byId("message").textContent = "This page has no data: it is the template that dyn view and --html fill.";
