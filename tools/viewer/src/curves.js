// Curves of a page regrouped: those of two recordings in one plot, and those of a body.
// A plot is {title, unit, names, values: row by row}. Of curves that are compared it has origins: [{name, colour, dashed}].
import { lastAt } from "./recording.js";

/** the moments of two recordings, in order */
export function unionOf(a, b) {
  return Float32Array.from([...new Set([...a, ...b])].sort((x, y) => x - y));
}

/** column i of a plot at other moments, interpolated; NaN where its recording has none */
function resampled(plot, i, from, moments, time) {
  const n = plot.names.length, end = from[moments - 1];
  return Float32Array.from(time, (t) => {
    if (t < from[0] || t > end) return NaN;
    const k = lastAt(from, moments, t), next = Math.min(k + 1, moments - 1), span = from[next] - from[k];
    const s = span > 0 ? (t - from[k]) / span : 0;
    return (1 - s) * plot.values[k * n + i] + s * plot.values[next * n + i];
  });
}

function woven(columns) {
  const out = new Float32Array(columns.length * (columns[0]?.length ?? 0));
  columns.forEach((column, i) => column.forEach((x, k) => (out[k * columns.length + i] = x)));
  return out;
}

/** sides: two {label, plots, time, moments}. Curves of one name have one colour; the second one's are dashed. */
export function compared(sides, time) {
  const titles = [...new Set(sides.flatMap(({ plots }) => plots.map((plot) => plot.title)))];
  return titles.map((title) => {
    const found = sides.map(({ plots }) => plots.find((plot) => plot.title === title));
    const names = [...new Set(found.flatMap((plot) => plot?.names ?? []))];
    const origins = [], columns = [];
    names.forEach((name, colour) => sides.forEach((side, k) => {
      const i = found[k]?.names.indexOf(name) ?? -1;
      if (i < 0) return;
      origins.push({ name, colour, dashed: k > 0, label: side.label });
      columns.push(resampled(found[k], i, side.time, side.moments, time));
    }));
    const unit = found.find(Boolean).unit;
    return { title, unit, names: origins.map(({ name, label }) => `${name} (${label})`), origins, values: woven(columns) };
  });
}

/** [{name, joint, plots}] of the bodies that have curves: those named by a joint, its coordinates, or a frame that it carries */
export function byBody(plots, model) {
  const jointOf = new Map();
  for (const frame of model.frames) jointOf.set(frame.name, frame.joint);
  model.joints.forEach((joint, id) => jointOf.set(joint.name, id));
  const bodies = model.joints.map((joint, id) => ({
    name: model.frames.find((frame) => frame.type === "BODY" && frame.joint === id)?.name ?? joint.name,
    joint: joint.name,
    plots: [],
  }));
  for (const plot of plots) {
    const of = plot.names.map((name, i) => jointOf.get((plot.origins?.[i].name ?? name).replace(/\[\d+\]$/, "")));
    for (const id of new Set(of)) {
      if (!id) continue; // no body's, or the world's
      const mine = of.flatMap((joint, i) => (joint === id ? [i] : [])), n = plot.names.length;
      const columns = mine.map((i) => Float32Array.from({ length: plot.values.length / n }, (_, k) => plot.values[k * n + i]));
      bodies[id].plots.push({ ...plot, names: mine.map((i) => plot.names[i]), values: woven(columns),
                              origins: plot.origins && mine.map((i) => plot.origins[i]) });
    }
  }
  return bodies.filter((body) => body.plots.length);
}
