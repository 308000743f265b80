// A simulation that goes on, over a WebSocket: what it is doing, and what the page asks of it.
import { Controls } from "./controls.js";
import { make, number } from "./dom.js";
import { Plot } from "./plots.js";
import { Push } from "./push.js";
import { parseState } from "./state.js";

const KEPT = 600; // of the plots: ten seconds

export class Live {
  constructor({ head, robot, scene, overlays, inspector, side, footer, message }) {
    Object.assign(this, { head, robot, scene, overlays, inspector, message });
    // a page that simulates by itself (capi/js/live.js), or a server
    this.socket = globalThis.dynSocket?.() ?? new WebSocket(location.href.replace(/^http/, "ws").replace(/[#?].*$/, "") + "ws");
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = (event) => this.#receive(event.data);
    this.socket.onclose = () => this.#say(
      "The simulation has ended, or refused this page. Start dyn view --live again, and open the address that it prints.");
    this.push = new Push(scene, robot, inspector, overlays.weight, (push) => this.send({ do: "push", ...push }));
    this.#buttons(footer);
    if (head.controls?.length) {
      this.controls = new Controls(head.controls, (command) => this.send(command));
      side.append(this.controls.box);
    }
    if (head.effects.length) this.#effects(side);
    this.history = [];
    this.plots = [
      ["energy", "J", ["kinetic", "potential", "mechanical"], (s) => [s.kinetic, s.potential, s.kinetic + s.potential]],
      ["contact force", "N, sum of all", ["force"], (s) => [s.contacts.reduce((sum, c) => sum + Math.hypot(...c.force), 0)]],
      ["time of a step", "us", ["time"], (s) => [s.step]],
      ["residual", "of the contact solver", ["residual"], (s) => [s.residual]],
    ].map(([title, unit, names, values]) => {
      const plot = new Plot({ title, unit, names, values: [], open: title !== "residual" }, [], () => {});
      side.append(plot.box);
      plot.once();
      return { plot, values };
    });
  }

  send(command) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(command));
  }

  #say(text) {
    this.message.textContent = text;
  }

  #buttons(footer) {
    this.pause = make("button", { id: "pause", onclick: () => this.send({ do: "pause", on: !this.state?.paused }) }, "pause");
    const speeds = [0.1, 0.25, 0.5, 1, 2].map((x) => make("option", { value: x, selected: x === 1 }, `${x}×`));
    const speed =
      make("select", { id: "speed", "aria-label": "speed", onchange: () => this.send({ do: "speed", factor: Number(speed.value) }) }, ...speeds);
    const drag = make("input", { type: "checkbox", id: "drag", onchange: () => (this.push.always = drag.checked) });
    this.label = make("output", { id: "clock" });
    const reset = () => {
      this.history = [];
      this.#say("");
      this.send({ do: "reset" });
    };
    // the command dyn has no such step
    const step = this.head.controls ? [make("button", { id: "step", onclick: () => this.send({ do: "step" }) }, "step")] : [];
    footer.append(
      this.pause, ...step, make("button", { id: "reset", onclick: reset }, "reset"), speed,
      make("label", {}, drag, " dragging pushes (or hold Shift)"), this.label);
  }

  #effects(side) {
    const boxes = this.head.effects.map((name) => make("input", { type: "checkbox", checked: true, id: `effect-${name}` }));
    const tell = () => this.send({ do: "effects", without: this.head.effects.filter((_, i) => !boxes[i].checked).join(",") });
    for (const box of boxes) box.addEventListener("change", tell);
    side.append(make(
      "details", { open: true }, make("summary", {}, "effects"),
      ...boxes.map((box, i) => make("label", {}, box, ` ${this.head.effects[i]}  `))));
  }

  #receive(data) {
    if (typeof data === "string") {
      const { error, controls, held } = JSON.parse(data);
      if (controls) this.controls?.show(controls, held);
      else this.#say(error ?? "");
      return;
    }
    const state = (this.state = parseState(data, this.head.model));
    this.robot.setPoses(state.positions, state.turns);
    this.overlays.setCom(...state.com);
    this.overlays.setContacts(state.contacts);
    if (state.tendons.length) this.overlays.setTendons(state.tendons);
    this.scene.track(this.overlays.com.position);
    this.push.update();
    this.scene.redraw();
    if (this.history.length && state.time < this.history.at(-1).time) this.history = [];
    if (!state.paused) this.history.push(state);
    if (this.history.length > KEPT) this.history.shift();
    const now = performance.now();
    if (now - (this.told ?? 0) < 200) return;
    this.told = now;
    this.pause.textContent = state.paused ? "go on" : "pause";
    this.label.textContent = `${state.time.toFixed(2)} s, ${number(state.rate, 2)}× real time`;
    this.inspector.show(state);
    for (const { plot, values } of this.plots) plot.setData(this.history.map((s) => s.time), this.history.flatMap(values));
  }
}
