// Sliders of what drives a running simulation: controls of actuators, or torques where there are none.
import { make, number, section } from "./dom.js";

export class Controls {
  /** controls: [{name, lower, upper}]; send(command) */
  constructor(controls, send) {
    const { box, once } = section("controls", "a slider that was moved holds its control", true, (element) => {
      this.rows = controls.map((control, index) => {
        const value = make("span", { className: "number" }, "0");
        const slider = make("input", {
          type: "range", step: "any", min: control.lower, max: control.upper, value: 0, "aria-label": control.name,
          oninput: () => {
            row.classList.add("held");
            value.textContent = number(Number(slider.value), 3);
            send({ do: "control", index, value: Number(slider.value) });
          },
        });
        slider.dataset.control = control.name;
        const row = make("div", { className: "joint" }, make("span", { title: control.name }, control.name), slider, value);
        element.append(row);
        return { row, slider, value };
      });
      element.append(make("button", { id: "release", onclick: () => send({ do: "release" }) }, "release all"));
    });
    this.box = box;
    once();
  }

  /** what they are now, and which of them the page holds */
  show(values, held) {
    this.rows.forEach(({ row, slider, value }, k) => {
      row.classList.toggle("held", held.includes(k));
      if (slider.matches(":active")) return; // under the pointer
      slider.value = values[k];
      value.textContent = number(values[k], 3);
    });
  }
}
