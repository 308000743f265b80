// Time: playing, scrubbing, speed.
import { make } from "./dom.js";

export class Player {
  constructor(element, recording, onTime) {
    this.recording = recording;
    this.onTime = onTime;
    this.time = recording.start;
    this.playing = false;
    this.speed = 1;
    this.button = make("button", { id: "play", onclick: () => this.play(!this.playing), title: "space" }, "play");
    this.slider = make("input", {
      id: "scrub",
      "aria-label": "time",
      type: "range",
      min: recording.start,
      max: recording.end,
      step: "any",
      value: recording.start,
      oninput: () => this.seek(Number(this.slider.value))
    });
    this.label = make("output", { id: "clock" });
    const speeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8].map((x) => make("option", { value: x, selected: x === 1 }, `${x}×`));
    this.select = make("select", { id: "speed", "aria-label": "speed", onchange: () => (this.speed = Number(this.select.value)) }, ...speeds);
    element.append(this.button, this.slider, this.label, this.select);
    window.addEventListener("keydown", (event) => this.#key(event));
  }

  #key(event) {
    if (["INPUT", "SELECT", "TEXTAREA"].includes(event.target.tagName) && event.key !== " ") return;
    const step = (this.recording.end - this.recording.start) / Math.max(this.recording.moments - 1, 1);
    if (event.key === " ") this.play(!this.playing);
    else if (event.key === "ArrowRight") this.seek(this.time + step);
    else if (event.key === "ArrowLeft") this.seek(this.time - step);
    else if (event.key === "Home") this.seek(this.recording.start);
    else return;
    event.preventDefault();
  }

  play(on) {
    if (on && this.time >= this.recording.end) this.seek(this.recording.start);
    this.playing = on;
    this.button.textContent = on ? "pause" : "play";
  }

  seek(t) {
    this.time = Math.min(Math.max(t, this.recording.start), this.recording.end);
    this.slider.value = this.time;
    this.label.textContent = `${this.time.toFixed(3)} s of ${this.recording.end.toFixed(2)} s`;
    this.onTime(this.time);
  }

  tick(seconds) {
    if (!this.playing) return;
    this.seek(this.time + seconds * this.speed);
    if (this.time >= this.recording.end) this.play(false);
  }
}
