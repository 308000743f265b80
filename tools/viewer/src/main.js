// The page: what its data are decides what it shows.
import "./style.css";
import { Beside } from "./beside.js";
import { compared, unionOf } from "./curves.js";
import { readPage } from "./data.js";
import { make, number } from "./dom.js";
import { Inspector } from "./inspect.js";
import { Kinematics } from "./kinematics.js";
import { Live } from "./live.js";
import { Overlays } from "./overlays.js";
import { Player } from "./player.js";
import { PlotList } from "./plotlist.js";
import { lastAt, Recording } from "./recording.js";
import { Robot } from "./robot.js";
import { Scene } from "./scene.js";
import { addTables } from "./tables.js";
import { addTools } from "./tools.js";

const byId = (id) => document.getElementById(id);

function heading(head) {
  const { model } = head;
  document.title = `${model.name} · dyn`;
  byId("header").append(
    make("b", {}, model.name),
    make("span", {}, `${model.joints.length - 1} joints, nq ${model.nq}, nv ${model.nv}, ${number(model.mass)} kg`),
    make("span", {}, `libdyn ${head.version}`));
  if (head.beside) {
    const [first, second] = head.beside.labels;
    byId("header").append(make("span", {}, `${first}, and `, make("span", { className: "second" }, second), " (dashed)"));
  }
}

// The robot, drawn, with its switches; a page is built on that.
function stage({ head, read, readBeside }) {
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
  const beside = head.beside && new Beside(head.beside, readBeside, scene);
  const both = (name, first) => (beside ? [first, beside[name]] : [first]);
  addTools(byId("tools"), {
    robots: both("robot", robot), scene, overlays: both("overlays", overlays), follow: head.kind === "live", beside
  });
  beside?.tint();
  const inspector = new Inspector(byId("link"), robot, scene);
  return { head, robot, recording, scene, overlays, beside, inspector, side: byId("side") };
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

function pose({ recording, robot, overlays }, t) {
  const now = recording.at(t), k = recording.index(t);
  robot.setPoses(now.positions, now.turns);
  overlays.setCom(...now.com);
  overlays.setContacts(recording.contactsAt(k));
  overlays.setTendons(recording.tendonsAt(k));
}

// What the time line and the plots are of: one recording, or two.
function shown(recording, beside) {
  const { start, end, moments, time, allPlots } = recording;
  if (!beside) return { start, end, moments, time, plots: allPlots };
  const other = beside.recording, both = unionOf(time, other.time);
  const sides = [recording, other].map((each, k) => (
    { label: beside.labels[k], plots: each.allPlots, time: each.time, moments: each.moments }));
  return { start: both[0], end: both[both.length - 1], moments: both.length, time: both, plots: compared(sides, both) };
}

function startRecorded(view) {
  const { head, recording, robot, scene, overlays, beside, inspector, side } = view;
  const { plots, time, ...line } = shown(recording, beside);
  const list = new PlotList(plots, time, head.model, (t) => player.seek(t));
  const player = new Player(byId("player"), line, (t) => {
    pose(view, t);
    if (beside) pose(beside, t);
    scene.track(overlays.com.position);
    list.mark(t);
    scene.redraw();
  });
  side.append(list.box);
  list.open();
  addTables(side, head);

  let before = performance.now(), told = -Infinity, at;
  const tellState = () => {
    const k = recording.index(player.time);
    at = player.time;
    inspector.show(
      { q: recording.row("q", k), v: recording.row("v", k), tau: recording.row("tau", k), contacts: recording.contactsAt(k) });
    list.values(lastAt(time, time.length, player.time));
  };
  // page.html#t=0.35 stands still at that moment
  const moment = Number(new URLSearchParams(location.hash.slice(1)).get("t") ?? NaN);
  player.seek(Number.isFinite(moment) ? moment : line.start);
  player.play(!Number.isFinite(moment));
  draw(scene, (now) => {
    player.tick((now - before) / 1000);
    before = now;
    if (player.time !== at && (!player.playing || now - told > 100))
      (told = now), tellState();  // text follows ten times a second
  });
  return { ...view, player, plots: list.plots };
}

const page = readPage();
if (page) {
  const view = stage(page);
  const start = page.head.kind === "live" ? startLive : view.recording.moments > 1 ? startRecorded : startStill;
  window.dynView = start(view); // for the console, and for tests
} else {
  byId("message").textContent = "This page has no data: it is the template that dyn view and --html fill.";
}
