// The page: what its data are decides what it shows.
import "./style.css";
import { readPage } from "./data.js";
import { make, number } from "./dom.js";
import { Inspector } from "./inspect.js";
import { Kinematics } from "./kinematics.js";
import { Live } from "./live.js";
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
  byId("header").append(
    make("b", {}, model.name),
    make("span", {}, `${model.joints.length - 1} joints, nq ${model.nq}, nv ${model.nv}, ${number(model.mass)} kg`),
    make("span", {}, `libdyn ${head.version}`));
}

// The robot, drawn, with its switches; a page is built on that.
function stage(head, read) {
  heading(head);
  const robot = new Robot(head.model, read);
  const recording = new Recording(head.recording, head.model, read);
  const first = recording.at(recording.start);
  robot.setPoses(first.positions, first.turns);
  const scene = new Scene(byId("canvas"), robot);
  scene.settle();
  const overlays = new Overlays(robot, scene);
  overlays.setCom(...first.com);
  overlays.setTendons(recording.tendonsAt(0));
  scene.track(overlays.com.position);
  addTools(byId("tools"), { robot, scene, overlays, follow: head.kind === "live" });
  return { head, robot, recording, scene, overlays, inspector: new Inspector(byId("link"), robot, scene), side: byId("side") };
}

function draw(scene, each = () => {}) {
  const frame = (now) => {
    each(now);
    scene.draw();
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

function startLive(view) {
  const live = new Live({ ...view, footer: byId("player"), message: byId("message") });
  addTables(view.side, view.head);
  draw(view.scene);
  return { ...view, live };
}

function startStill(view) {
  const { recording, robot, inspector } = view;
  const kinematics = new Kinematics(robot, recording.row("q", 0));
  const state = () => inspector.show({ q: kinematics.q, contacts: [] });
  view.side.append(kinematics.panel(() => {
    view.overlays.setCom(...kinematics.com().toArray());
    view.overlays.setTendons(new Float32Array()); // their paths are those of the drawn configuration
    view.scene.redraw();
    state();
  }));
  addTables(view.side, view.head);
  state();
  draw(view.scene);
  return { ...view, kinematics };
}

function startRecorded(view) {
  const { head, recording, robot, scene, overlays, inspector, side } = view;
  const plots = [recording.contactPlot(), ...recording.plots].filter(Boolean).map(
    (plot) => new Plot({...plot, open: OPEN.includes(plot.title) }, recording.time, (t) => player.seek(t)));
  const player = new Player(byId("player"), recording, (t) => {
    const now = recording.at(t);
    robot.setPoses(now.positions, now.turns);
    overlays.setCom(...now.com);
    scene.track(overlays.com.position);
    overlays.setContacts(recording.contactsAt(recording.index(t)));
    overlays.setTendons(recording.tendonsAt(recording.index(t)));
    for (const plot of plots) plot.mark(t);
    scene.redraw();
  });
  for (const plot of plots) side.append(plot.box), plot.once();
  addTables(side, head);

  let before = performance.now(), told = -Infinity, shown;
  const tellState = () => {
    const k = recording.index(player.time);
    shown = player.time;
    inspector.show(
      { q: recording.row("q", k), v: recording.row("v", k), tau: recording.row("tau", k), contacts: recording.contactsAt(k) });
    for (const plot of plots) plot.values(k);
  };
  // page.html#t=0.35 stands still at that moment
  const moment = Number(new URLSearchParams(location.hash.slice(1)).get("t") ?? NaN);
  player.seek(Number.isFinite(moment) ? moment : recording.start);
  player.play(!Number.isFinite(moment));
  draw(scene, (now) => {
    player.tick((now - before) / 1000);
    before = now;
    if (player.time !== shown && (!player.playing || now - told > 100))
      (told = now), tellState();  // text follows ten times a second
  });
  return { ...view, player, plots };
}

const page = readPage();
if (page) {
  const view = stage(page.head, page.read);
  const start = page.head.kind === "live" ? startLive : view.recording.moments > 1 ? startRecorded : startStill;
  window.dynView = start(view); // for the console, and for tests
} else {
  byId("message").textContent = "This page has no data: it is the template that dyn view and --html fill.";
}
