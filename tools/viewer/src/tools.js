// The box of switches: what is drawn, where it is seen from.
import { make } from "./dom.js";

export function addTools(element, { robot, scene, overlays }) {
  const toggle = (id, label, on, set) => {
    const box =
      make("input", { type: "checkbox", id: `show-${id}`, checked: on, onchange: () => (set(box.checked), scene.redraw()) });
    set(on);
    element.append(make("label", {}, box, ` ${label}`));
  };
  const { visual, collision } = robot.layers;
  if (visual.length) toggle("visual", "visual shapes", true, (on) => robot.show("visual", on));
  else robot.drawCollisionAsVisual();
  if (collision.length) toggle("collision", "collision shapes", !visual.length, (on) => robot.show("collision", on));
  toggle("skeleton", "joints as lines", !visual.length && !collision.length, (on) => robot.show("skeleton", on));
  toggle("frames", "frames", false, (on) => overlays.show("frames", on));
  toggle("com", "centre of mass", true, (on) => overlays.show("com", on));
  toggle("inertia", "inertia ellipsoids", false, (on) => overlays.show("inertia", on));
  toggle("contacts", "contacts and forces", true, (on) => overlays.show("contacts", on));
  if (overlays.groups.tendons.length) toggle("tendons", "tendons", true, (on) => overlays.show("tendons", on));
  toggle("follow", "camera follows", false, (on) => (scene.follow = on));
  element.append(make(
    "div", { className: "row" },
    ...["oblique", "front", "side", "top"].map(
      (name) => make("button", { id: `look-${name}`, onclick: () => scene.look(name) }, name))));
}
