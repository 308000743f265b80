// The box of switches: what is drawn, where it is seen from.
import { make } from "./dom.js";

const NARROW = 640; // px: on a phone the box is folded

export function addTools(place, { robots, scene, overlays, follow, beside }) {
  const element = make("details", { open: window.innerWidth > NARROW }, make("summary", {}, "view"));
  place.append(element);
  const toggle = (id, label, on, set) => {
    const box =
      make("input", { type: "checkbox", id: `show-${id}`, checked: on, onchange: () => (set(box.checked), scene.redraw()) });
    set(on);
    element.append(make("label", {}, box, ` ${label}`));
  };
  const layer = (name, label, on) => toggle(name, label, on, (yes) => robots.forEach((robot) => robot.show(name, yes)));
  const drawn = (name, label, on) => toggle(name, label, on, (yes) => overlays.forEach((each) => each.show(name, yes)));
  const { visual, collision } = robots[0].layers;
  if (visual.length) layer("visual", "visual shapes", true);
  for (const robot of robots)
    if (!robot.hasVisual) robot.drawCollisionAsVisual();
  if (collision.length) layer("collision", "collision shapes", !visual.length);
  layer("skeleton", "joints as lines", !visual.length && !collision.length);
  drawn("frames", "frames", false);
  drawn("com", "centre of mass", true);
  drawn("inertia", "inertia ellipsoids", false);
  drawn("contacts", "contacts and forces", true);
  if (overlays[0].groups.tendons.length) drawn("tendons", "tendons", true);
  if (beside) toggle("beside", "one beside the other", true, (on) => beside.moveAside(on));
  toggle("follow", "camera follows", follow, (on) => (scene.follow = on));
  const row = (...buttons) => make("div", { className: "row" }, ...buttons);
  element.append(
    row(...["oblique", "front", "side", "top"].map(
      (name) => make("button", { id: `look-${name}`, onclick: () => scene.look(name) }, name))),
    row(
      make("button", { id: "fit", title: "f", onclick: () => scene.fit() }, "fit"),
      make("button", { id: "save-picture", title: "a PNG file", onclick: () => savePicture(scene) }, "picture"),
      ...(window.MediaRecorder ? [videoButton(scene)] : [])));
  window.addEventListener("keydown", (event) => {
    if (event.key === "f" && !["INPUT", "SELECT", "TEXTAREA"].includes(event.target.tagName)) scene.fit();
  });
}

function save(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function savePicture(scene) {
  scene.redraw(), scene.draw();
  scene.canvas.toBlob((blob) => save(blob, `${document.title}.png`));
}

/** what is drawn between two clicks, as a WebM file */
function videoButton(scene) {
  let recorder;
  const button = make("button", {
    id: "save-video", title: "a WebM file, from one click to the next",
    onclick() {
      if (recorder) {
        recorder.stop();
        return;
      }
      const parts = [];
      recorder = new MediaRecorder(scene.canvas.captureStream(30));
      recorder.ondataavailable = ({ data }) => parts.push(data);
      recorder.onstop = () => {
        save(new Blob(parts, { type: recorder.mimeType }), `${document.title}.webm`);
        recorder = undefined;
        button.textContent = "video";
      };
      recorder.start();
      button.textContent = "stop";
    },
  }, "video");
  return button;
}
