// What the command said of the whole: numbers, ledger, effects and what they take, notes.
import { make, number, section } from "./dom.js";

const cell = (value) =>
  (typeof value === "number" || value === null ? make("td", { className: "number" }, number(value)) :
                                                 make("td", {}, String(value)));

export function table(heads, rows) {
  return make(
    "table", {}, make("tr", {}, ...heads.map((head) => make("th", {}, head))),
    ...rows.map((row) => make("tr", {}, ...row.map(cell))));
}

export function addTables(side, head) {
  const add = (title, hint, open, ...content) => {
    const { box, once } = section(title, hint, open, (element) => element.append(...content));
    side.append(box);
    once();
  };
  const answer = head.answer ?? {};
  if (answer.steps !== undefined) {
    const facts = [
      ["simulated", `${number(answer.duration)} s in ${answer.steps} steps of ${answer.integrator}`],
      ["computing", `${number(answer.wall_s)} s: ${number(answer.real_time_factor)} times real time`],
      ["error estimate", `${number(answer.error_estimate)} (${answer.error_estimate_method})`],
      ["energy drift", `${number(answer.energy.drift_max)} J at most`],
      [
        "contact",
        `up to ${answer.contacts_max} points, deepest ${number(answer.penetration_max)} m, residual ${
          number(answer.residual_max)}`
      ],
      ["solver", answer.solver]
    ];
    add("result", "", true, table([], facts));
  }
  if (answer.ledger) {
    const rows =
      Object.entries(answer.ledger)
        .map(
          ([name, value]) => [name.replaceAll("_", " "), Array.isArray(value) ? value.map((x) => number(x)).join(", ") : value]);
    add("error ledger", "J; what changed the energy, and what nothing accounts for", true, table(["", "at the end"], rows));
  }
  if (answer.profile) {
    const rows = answer.profile.effects.filter((e) => e.active)
                   .map((e) => [e.name, e.ns === undefined ? null : e.ns / 1000, e.magnitude ?? null, e.reason]);
    add(
      "time per effect", "what a step takes less without it, and how far the result then is off", true,
      table(["effect", "µs a step", "m, rad", ""], rows));
  } else if (answer.effects) {
    add("effects", "", false, table(["effect", "", ""], answer.effects.map((e) => [e.name, e.active ? "on" : "off", e.reason])));
  }
  if (head.info) addInfo(add, head.info);
  if (head.notes?.length) add("notes", "", true, ...head.notes.map((note) => make("p", { className: "note" }, note)));
}

function addInfo(add, info) {
  const range = (first, n) => (n > 1 ? `${first}..${first + n - 1}` : n ? String(first) : "");
  add(
    "joints", String(info.joints.length - 1), false,
    table(
      ["", "name", "type", "parent", "q", "v"],
      info.joints.slice(1).map(
        (j, i) => [String(i + 1), j.name, j.type, String(j.parent), range(j.idx_q, j.nq), range(j.idx_v, j.nv)])));
  add(
    "frames", String(info.frames.length), false,
    table(
      ["", "name", "type", "joint", "kg"],
      info.frames.map((f, i) => [String(i), f.name, f.type, String(f.joint), f.mass || ""])));
  if (info.tendons.length)
    add(
      "tendons", String(info.tendons.length), false,
      table(
        ["", "name", "type", "length", "stiffness", "damping"],
        info.tendons.map((t, i) => [String(i), t.name, t.type, t.length, t.stiffness || "", t.damping || ""])));
  if (info.actuators.length)
    add(
      "actuators", String(info.actuators.length), false,
      table(
        ["", "name", "type", "acts on"],
        info.actuators.map((a, i) => [String(i), a.name, a.type, `${a.transmission} ${a.target}`])));
  add("effects", "", true, table(["effect", "", ""], info.effects.map((e) => [e.name, e.active ? "on" : "off", e.reason])));
  add(
    "load report", String(info.report.length), false,
    table(["level", "line", ""], info.report.map((r) => [r.level, String(r.line || ""), r.message])));
}
