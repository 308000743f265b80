// The plots of a recording: one a quantity, or those of each body, with a field that searches bodies.
import { byBody } from "./curves.js";
import { make, section } from "./dom.js";
import { Plot } from "./plots.js";

const OPEN = ["contact forces", "energy", "q"];

export class PlotList {
  constructor(plots, time, model, onSeek) {
    const plot = (data, open) => new Plot({ ...data, open }, time, onSeek);
    this.plots = plots.map((data) => plot(data, OPEN.includes(data.title)));
    this.quantities = make("div", {}, ...this.plots.map(({ box }) => box));
    this.bodies = make("div", { hidden: true });
    this.box = make("div", {}, this.quantities, this.bodies);
    const bodies = byBody(plots, model);
    if (bodies.length < 2) return;
    const choice = make("select", { id: "plots-by", "aria-label": "how plots are grouped", onchange: () => {
      const body = choice.value === "body";
      if (body && !this.bodies.childElementCount) this.#fill(bodies, plot);
      (this.quantities.hidden = body), (this.bodies.hidden = !body);
    } }, make("option", { value: "quantity" }, "plots by quantity"), make("option", { value: "body" }, "plots by body"));
    this.box.prepend(choice);
  }

  /** once the list is in the page, which gives plots their width */
  open() {
    for (const plot of this.plots) plot.once();
  }

  #fill(bodies, plot) {
    const boxes = bodies.map(({ name, joint, plots }) => {
      const { box } = section(name, joint === name ? "" : `joint ${joint}`, false, (element) => {
        const mine = plots.map((data) => plot(data, true));
        this.plots.push(...mine);
        element.append(...mine.map((each) => each.box));
        for (const each of mine) each.once(), each.mark(this.time), each.values(this.moment);
      });
      return box;
    });
    const field = make("input", {
      id: "search-bodies", type: "search", placeholder: `search ${bodies.length} bodies`, "aria-label": "bodies",
      oninput: () => {
        const wanted = field.value.toLowerCase();
        boxes.forEach((box, k) => {
          const { name, joint } = bodies[k];
          box.hidden = !`${name} ${joint}`.toLowerCase().includes(wanted);
        });
      },
    });
    this.bodies.append(field, ...boxes);
  }

  mark(t) {
    this.time = t;
    for (const plot of this.plots) plot.mark(t);
  }
  values(k) {
    this.moment = k;
    for (const plot of this.plots) plot.values(k);
  }
}
