// A link pulled by the pointer, as by a spring from where it was taken hold of to where the pointer is.
import * as THREE from "three";

const STIFFNESS = 4; // weights by the size of what is shown

export class Push {
  /** send({frame, point, force}): point in the frame, force in the world's axes; zero: let go */
  constructor(scene, robot, inspector, weight, send) {
    Object.assign(this, { scene, robot, inspector, weight, send });
    this.always = false;
    this.line = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineBasicMaterial({ color: 0x1c2430, depthTest: false }));
    this.line.visible = false;
    this.line.frustumCulled = false;
    scene.overlays.add(this.line);
    const canvas = scene.canvas;
    canvas.addEventListener("pointerdown", (event) => this.#take(event), { capture: true }); // before the camera's controls
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => this.#release());
  }

  #take(event) {
    if (!(event.shiftKey || this.always)) return;
    const hit = this.inspector.hit(event);
    const frame = hit?.object.userData.frame;
    if (frame === undefined || this.robot.model.frames[frame].joint === 0) return;
    this.scene.controls.enabled = false;
    this.scene.canvas.setPointerCapture(event.pointerId);
    this.held = { frame, point: this.robot.frames[frame].worldToLocal(hit.point.clone()) };
    this.plane =
      new THREE.Plane().setFromNormalAndCoplanarPoint(this.scene.camera.getWorldDirection(new THREE.Vector3()), hit.point);
    this.target = hit.point.clone();
  }

  #move(event) {
    if (!this.held) return;
    this.inspector.aim(event).intersectPlane(this.plane, this.target);
  }

  #release() {
    if (!this.held) return;
    this.send({ ...this.held, point: this.held.point.toArray(), force: [0, 0, 0] });
    this.held = null;
    this.line.visible = false;
    this.scene.controls.enabled = true;
  }

  /** with each state: the spring's force from where the link is now */
  update() {
    if (!this.held) return;
    const from = this.robot.frames[this.held.frame].localToWorld(this.held.point.clone());
    const force = this.target.clone().sub(from).multiplyScalar((STIFFNESS * this.weight) / this.scene.size);
    this.line.geometry.setFromPoints([from, this.target]);
    this.line.visible = true;
    this.send({ ...this.held, point: this.held.point.toArray(), force: force.toArray() });
  }
}
