// Plots over time, each with a line at the time shown; a click goes there. A part that is dragged over is shown larger, in all of
// them.
import Dygraph from "dygraphs";
import "dygraphs/dist/dygraph.css";
import { make, number, section } from "./dom.js";

const COLOURS = ["#1f77b4", "#d1495b", "#2a9d5c", "#8e63b5", "#e08a1e", "#7a5548", "#17a2b8", "#c2185b", "#5d6d7e", "#9aa21e"];
const HEIGHT = 170;
const MANY = 12; // curves, from which on they can be searched

export class Plot {
  static #drawn = []; // those opened so far

  constructor(plot, time, onSeek) {
    this.plot = plot;
    this.time = time;
    this.onSeek = onSeek;
    const { box, once } = section(plot.title, plot.unit, plot.open ?? false, (element) => this.#fill(element));
    this.box = box;
    this.once = once;
  }

  /** for each moment: time, and a value of each curve */
  #rows() {
    const n = this.plot.names.length;
    return Array.from(this.time, (t, k) => [t, ...this.plot.values.slice(k * n, (k + 1) * n)]);
  }

  #fill(element) {
    const colours = this.plot.names.map((_, i) => COLOURS[(this.plot.origins?.[i].colour ?? i) % COLOURS.length]);
    const dashed = this.plot.names.map((_, i) => [String(i), { strokePattern: this.plot.origins?.[i].dashed ? [5, 3] : null }]);
    this.line = make("div", { className: "cursor", style: "display: none" });
    this.clock = make("span", { className: "number" });
    this.numbers = colours.map(() => make("span", { className: "number" }));
    const key = (name, i) => {
      const entry = make(
        "span", { style: `color: ${colours[i]}`, onclick: () => this.graph.setVisibility(i, !entry.classList.toggle("off")) },
        `${name} `, this.numbers[i]);
      return entry;
    };
    const holder = make("div");
    const keys = this.plot.names.map(key);
    if (keys.length > MANY) element.append(this.#search(keys));
    element.append(
      make("div", { className: "plot" }, holder, this.line),
      make("div", { className: "key" }, make("span", {}, "t ", this.clock), ...keys));
    const width = () => Math.max(element.clientWidth - 4, 200);
    this.graph = new Dygraph(holder, this.time.length ? this.#rows() : [[0, ...colours.map(() => NaN)]], {
      labels: ["t", ...colours.map((_, i) => String(i))],  // names need not differ
      colors: colours,
      series: Object.fromEntries(dashed),
      width: width(),
      height: HEIGHT,
      legend: "never",
      strokeWidth: 1.2,
      gridLineColor: "#d4d8de",
      axisLineColor: "#9aa3ae",
      axisLabelFontSize: 11,
      axes: {
        x: { axisLabelFormatter: (x) => number(x) },
        y: { axisLabelFormatter: (y) => number(y), axisLabelWidth: 52, pixelsPerLabel: 24 }
      },
      highlightCallback: (event, x, points, row) => Plot.#drawn.forEach((plot) => plot.values(row)),
      clickCallback: (event) => this.onSeek(this.graph.toDataXCoord(this.graph.eventToDomCoords(event)[0])),
      zoomCallback: (from, to) =>
        Plot.#drawn.forEach((plot) => plot !== this && plot.graph.updateOptions({ dateWindow: [from, to] })),
      drawCallback: () => this.mark(this.last),
    });
    new ResizeObserver(() => element.open && this.graph.resize(width(), HEIGHT)).observe(element);
    Plot.#drawn.push(this);
    this.mark(this.last);
  }

  /** shows curves whose names have what is written */
  #search(keys) {
    const field = make("input", {
      type: "search", placeholder: `search ${keys.length} curves`, "aria-label": `curves of ${this.plot.title}`,
      oninput: () => {
        const wanted = field.value.toLowerCase();
        const shown = this.plot.names.map((name) => name.toLowerCase().includes(wanted));
        keys.forEach((entry, i) => ((entry.hidden = !shown[i]), entry.classList.remove("off")));
        this.graph.setVisibility(shown);
      },
    });
    return field;
  }

  mark(t) {
    this.last = t;
    if (!this.graph || !this.box.open || t === undefined) return;
    const { x, w } = this.graph.getArea(), at = this.graph.toDomXCoord(t);
    this.line.style.display = at < x || at > x + w ? "none" : "";
    this.line.style.transform = `translateX(${at}px)`;
  }

  /** numbers of moment k, for they take more than a line to move */
  values(k) {
    if (!this.graph || !this.box.open || k >= this.time.length) return;
    this.clock.textContent = `${this.time[k].toFixed(3)} s`;
    this.numbers.forEach((element, i) => (element.textContent = number(this.plot.values[k * this.numbers.length + i])));
  }

  setData(time, rows) {
    this.time = time;
    this.plot.values = rows;
    if (!this.graph || !this.box.open || !time.length) return;
    this.graph.updateOptions({ file: this.#rows(), dateWindow: null });
    this.values(time.length - 1);
  }
}
