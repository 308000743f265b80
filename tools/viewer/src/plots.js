// Plots over time, each with a line at the time shown; a click goes there.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { number, section } from "./dom.js";

const COLOURS = ["#1f77b4", "#d1495b", "#2a9d5c", "#8e63b5", "#e08a1e", "#7a5548", "#17a2b8", "#c2185b", "#5d6d7e", "#9aa21e"];

/** columns of row-major values */
function columns(plot, moments) {
  const n = plot.names.length;
  return plot.names.map((_, c) => Float64Array.from({ length: moments }, (_, k) => plot.values[k * n + c]));
}

export class Plot {
  constructor(plot, time, onSeek) {
    this.plot = plot;
    this.time = time;
    this.onSeek = onSeek;
    const { box, once } = section(plot.title, plot.unit, plot.open ?? false, (element) => this.#fill(element));
    this.box = box;
    this.once = once;
  }

  #fill(element) {
    const holder = document.createElement("div");
    holder.className = "plot";
    element.append(holder);
    const width = () => Math.max(element.clientWidth - 4, 200);
    this.u = new uPlot(
      {
        width: width(),
        height: 170,
        cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
        scales: { x: { time: false } },
        axes: [{ size: 28, font: "11px system-ui" }, { size: 58, font: "11px system-ui", values: (_, ticks) => ticks.map((x) => number(x, 4)) }],
        series: [
          { label: "t", value: (_, x) => (x === null ? "" : `${x.toFixed(3)} s`) },
          ...this.plot.names.map((label, i) => ({ label, stroke: COLOURS[i % COLOURS.length], width: 1.2, points: { show: false }, value: (_, x) => number(x) })),
        ],
      },
      [Float64Array.from(this.time), ...columns(this.plot, this.time.length)],
      holder,
    );
    this.line = document.createElement("div");
    this.line.className = "cursor";
    this.u.over.append(this.line);
    this.u.over.addEventListener("click", () => this.u.cursor.left >= 0 && this.onSeek(this.u.posToVal(this.u.cursor.left, "x")));
    new ResizeObserver(() => element.open && this.u.setSize({ width: width(), height: 170 })).observe(element);
    if (this.last !== undefined) this.mark(this.last);
  }

  mark(t) {
    this.last = t;
    if (!this.u || !this.box.open) return;
    const { min, max } = this.u.scales.x;
    this.line.style.display = t < min || t > max ? "none" : "";
    this.line.style.transform = `translateX(${this.u.valToPos(t, "x")}px)`;
  }

  /** legend values at moment k, for it takes more than a line to move */
  values(k) {
    if (this.u && this.box.open) this.u.setLegend({ idx: k }, false);
  }

  setData(time, rows) {
    this.time = time;
    this.plot.values = rows;
    if (this.u && this.box.open) this.u.setData([Float64Array.from(time), ...columns(this.plot, time.length)]);
  }
}
