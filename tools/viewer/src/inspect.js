// Picking a link: its name, mass, frame and what moves it.
import * as THREE from "three";
import { make, number } from "./dom.js";

const rows = (list) =>
  make("table", {}, ...list.map(([name, value]) => make("tr", {}, make("th", {}, name), make("td", {}, value))));
const triple = (v) => `${number(v.x)}, ${number(v.y)}, ${number(v.z)}`;

export class Inspector {
  constructor(element, robot, scene) {
    this.element = element;
    this.robot = robot;
    this.scene = scene;
    this.ray = new THREE.Raycaster();
    let down = null;
    scene.canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    scene.canvas.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4 && !event.shiftKey)
        this.select(this.hit(event)?.object.userData.frame);
      down = null;
    });
  }

  /** the ray from the eye through the pointer */
  aim(event) {
    const box = this.scene.canvas.getBoundingClientRect();
    this.ray.setFromCamera(
      new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height),
      this.scene.camera);
    return this.ray.ray;
  }

  /** the first thing drawn below the pointer */
  hit(event) {
    this.aim(event);
    return this.ray.intersectObjects(this.robot.pickable.filter((mesh) => mesh.visible), false)[0];
  }

  select(frame) {
    for (const mesh of this.robot.pickable) mesh.material.emissive.set(mesh.userData.frame === frame ? 0x7a3b10 : 0);
    this.frame = frame;
    this.show();
    this.scene.redraw();
  }

  /** q and v of the joint, contacts: what holds now, where it is known */
  show(state = this.state) {
    this.state = state;
    this.element.replaceChildren();
    if (this.frame === undefined) return;
    const frame = this.robot.model.frames[this.frame], joint = this.robot.model.joints[frame.joint];
    const at = new THREE.Vector3().setFromMatrixPosition(this.robot.frames[this.frame].matrixWorld);
    const list = [
      ["mass", frame.mass ? `${number(frame.mass)} kg` : "none of its own"], ["frame", `${this.frame}, at ${triple(at)} m`],
      ["joint", frame.joint ? `${joint.name} (${joint.type})` : "the world"]
    ];
    if (frame.mass) list.push(["centre of mass", `${frame.com.map((x) => number(x, 3)).join(", ")} m`]);
    const values = (name, array, first, n) =>
      array && n && list.push([name, Array.from(array.slice(first, first + n), (x) => number(x)).join(", ")]);
    if (state) {
      values("q", state.q, joint.q, joint.nq);
      values("v", state.v, joint.v, joint.nv);
      values("tau", state.tau, joint.v, joint.nv);
      const mine =
        (state.contacts ?? []).filter((c) => [c.a, c.b].some((shape) => this.robot.model.shapes[shape].frame === this.frame));
      if (mine.length)
        list.push([
          "contacts",
          `${mine.length}, ${number(Math.hypot(...[0, 1, 2].map((i) => mine.reduce((sum, c) => sum + c.force[i], 0))))} N`
        ]);
    }
    this.element.append(make("b", {}, frame.name), rows(list));
  }
}
