// A second recording in the picture of the first one: beside it, or over it.
import * as THREE from "three";
import { Overlays } from "./overlays.js";
import { Recording } from "./recording.js";
import { Robot } from "./robot.js";

export const TINT = 0xe08a1e;
const APART = 0.75; // of the first robot's size

export class Beside {
  constructor({ head, labels }, read, scene) {
    this.labels = labels;
    this.scene = scene;
    this.robot = new Robot(head.model, read);
    this.recording = new Recording(head.recording, head.model, read);
    this.place = new THREE.Group();
    const drawn = new THREE.Group();
    this.place.add(this.robot.root, drawn);
    scene.add(this.robot, this.place);
    const first = this.recording.at(this.recording.start);
    this.robot.setPoses(first.positions, first.turns);
    this.overlays = new Overlays(this.robot, { size: scene.size, overlays: drawn, redraw: () => scene.redraw() });
    this.overlays.setTendons(this.recording.tendonsAt(0));
  }

  // After the switches are made, which may give shapes their looks.
  tint() {
    const tint = new THREE.Color(TINT);
    for (const { material } of this.robot.pickable) material.color.lerp(tint, 0.6);
  }

  moveAside(on) {
    this.place.position.y = on ? APART * this.scene.size : 0;
    this.place.updateMatrixWorld(true);
    this.scene.fit();
  }
}
