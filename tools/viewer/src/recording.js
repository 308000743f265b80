// A recorded simulation: what it was at any time, between two moments interpolated.
/** the last of so many moments at or before t */
export function lastAt(time, moments, t) {
  let low = 0, high = moments - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

export class Recording {
  constructor(recording, model, read) {
    this.model = model;
    this.time = read(recording.time);
    this.moments = recording.moments;
    this.positions = read(recording.positions);
    this.turns = read(recording.turns);
    this.com = read(recording.com);
    this.plots = recording.plots.map((plot) => ({ ...plot, values: read(plot.values) }));
    const c = recording.contacts;
    this.contacts = {
      first: read(c.first),
      position: read(c.position),
      force: read(c.force),
      distance: read(c.distance),
      shapes: read(c.shapes)
    };
    const t = recording.tendons;
    this.tendons = t && { first: read(t.first), pieces: read(t.pieces) };
    this.now = {
      positions: new Float32Array(3 * (model.joints.length - 1)),
      turns: new Float32Array(4 * (model.joints.length - 1)),
      com: [0, 0, 0]
    };
  }

  get start() {
    return this.time[0];
  }
  get end() {
    return this.time[this.moments - 1];
  }

  /** the last moment at or before t */
  index(t) {
    return lastAt(this.time, this.moments, t);
  }

  at(t) {
    const k = this.index(t), next = Math.min(k + 1, this.moments - 1);
    const span = this.time[next] - this.time[k];
    const s = span > 0 ? Math.min(Math.max((t - this.time[k]) / span, 0), 1) : 0;
    const mix = (from, to, width) => {
      for (let i = 0; i < width; ++i) to[i] = (1 - s) * from[k * width + i] + s * from[next * width + i];
    };
    mix(this.positions, this.now.positions, this.now.positions.length);
    mix(this.com, this.now.com, 3);
    const width = this.now.turns.length;
    for (let i = 0; i < width; i += 4) { // the shorter way round, made a unit by who takes it
      const a = k * width + i, b = next * width + i, q = this.turns;
      const sign = q[a] * q[b] + q[a + 1] * q[b + 1] + q[a + 2] * q[b + 2] + q[a + 3] * q[b + 3] < 0 ? -s : s;
      for (let j = 0; j < 4; ++j) this.now.turns[i + j] = (1 - s) * q[a + j] + sign * q[b + j];
    }
    return this.now;
  }

  /** pieces of tendons at moment k: see Overlays.setTendons */
  tendonsAt(k) {
    return this.tendons?.pieces.subarray(7 * this.tendons.first[k], 7 * this.tendons.first[k + 1]);
  }

  #moves(shape) {
    return this.model.frames[this.model.shapes[shape].frame].joint !== 0;
  }

  /** contacts of moment k, forces on what moves (of two that move: on the second) */
  contactsAt(k) {
    const { first, position, force, distance, shapes } = this.contacts;
    const out = [];
    for (let i = first[k]; i < first[k + 1]; ++i) {
      const a = shapes[2 * i], b = shapes[2 * i + 1], sign = this.#moves(b) ? 1 : -1;
      out.push({
        a,
        b,
        on: sign > 0 ? b : a,
        distance: distance[i],
        position: position.subarray(3 * i, 3 * i + 3),
        force: [0, 1, 2].map((j) => sign * force[3 * i + j])
      });
    }
    return out;
  }

  /** those of the page, and contact forces */
  get allPlots() {
    return [this.contactPlot(), ...this.plots].filter(Boolean);
  }

  /** what the plot of that title has at moment k */
  row(title, k) {
    const plot = this.plots.find((p) => p.title === title);
    return plot?.values.subarray(k * plot.names.length, (k + 1) * plot.names.length);
  }

  /** sums of contact forces by the link they act on, as a plot */
  contactPlot(most = 16) {
    const links = new Map();
    for (let k = 0; k < this.moments; ++k)
      for (const c of this.contactsAt(k)) {
        const frame = this.model.shapes[c.on].frame;
        if (!links.has(frame)) {
          if (links.size === most) continue;
          links.set(frame, new Float32Array(3 * this.moments));
        }
        for (let j = 0; j < 3; ++j) links.get(frame)[3 * k + j] += c.force[j];
      }
    if (!links.size) return null;
    const names = [...links.keys()].map((frame) => this.model.frames[frame].name);
    const values = new Float32Array(names.length * this.moments);
    [...links.values()].forEach((sums, i) => {
      for (let k = 0; k < this.moments; ++k)
        values[k * names.length + i] = Math.hypot(sums[3 * k], sums[3 * k + 1], sums[3 * k + 2]);
    });
    return { title: "contact forces", unit: "N", names, values };
  }
}
