// Joints of one coordinate moved by hand: where everything then is. Other joints stay as they were.
import * as THREE from "three";
import { make, number, section } from "./dom.js";
import { matrixOf } from "./shapes.js";

const MOVABLE = ["revolute", "continuous", "prismatic", "helical"];

/** the joint's motion at coordinate q, in its frame */
function motion(joint, q) {
  const axis = new THREE.Vector3(...joint.axis);
  if (joint.type === "prismatic") return new THREE.Matrix4().makeTranslation(...joint.axis.map((x) => x * q));
  const turn = new THREE.Matrix4().makeRotationAxis(axis, q);
  return joint.type === "helical" ? turn.setPosition(axis.multiplyScalar(joint.pitch * q)) : turn;
}

export class Kinematics {
  constructor(robot, q) {
    this.robot = robot;
    this.q = Float64Array.from(q);
    this.joints = robot.model.joints;
    this.movable = this.joints.map((joint, id) => id > 0 && joint.nq === 1 && MOVABLE.includes(joint.type));
    // from each joint's parent to it, as it stands
    this.still = robot.joints.map((node, id) => {
      node.updateMatrix();
      const parent = robot.joints[this.joints[id].parent];
      return id ? parent.matrix.clone().invert().multiply(node.matrix) : new THREE.Matrix4();
    });
  }

  #coordinate(joint) {
    return joint.mimic ? joint.mimic.ratio * this.q[this.joints[joint.mimic.leader].q] + joint.mimic.offset : this.q[joint.q];
  }

  apply() {
    const world = this.joints.map(() => new THREE.Matrix4());
    this.joints.forEach((joint, id) => {
      if (!id) return;
      const moves = this.movable[id] || (joint.mimic && MOVABLE.includes(joint.type));
      const relative = moves ? matrixOf(joint.placement).multiply(motion(joint, this.#coordinate(joint))) : this.still[id];
      world[id].multiplyMatrices(world[joint.parent], relative);
      world[id].decompose(this.robot.joints[id].position, this.robot.joints[id].quaternion, new THREE.Vector3());
    });
    this.robot.root.updateMatrixWorld(true);
  }

  /** the centre of mass of what moves */
  com() {
    const sum = new THREE.Vector3();
    let mass = 0;
    this.robot.model.frames.forEach((frame, id) => {
      if (!frame.mass || !frame.joint) return;
      sum.addScaledVector(this.robot.frames[id].localToWorld(new THREE.Vector3(...frame.com)), frame.mass);
      mass += frame.mass;
    });
    return mass ? sum.divideScalar(mass) : sum;
  }

  /** a slider for each */
  panel(onChange) {
    const { box, once } = section("joints", "rad, m; drag to move", true, (element) => {
      this.joints.forEach((joint, id) => {
        if (!this.movable[id]) return;
        const bound = (x, otherwise) => (Number.isFinite(x) ? x : otherwise);
        const value = make("span", { className: "number" }, number(this.q[joint.q], 3));
        const slider = make("input", {
          type: "range", step: "any", min: bound(joint.lower[0] ?? NaN, -Math.PI), max: bound(joint.upper[0] ?? NaN, Math.PI), value: this.q[joint.q],
          oninput: () => {
            this.q[joint.q] = Number(slider.value);
            value.textContent = number(this.q[joint.q], 3);
            this.apply();
            onChange();
          },
        });
        slider.dataset.joint = joint.name;
        element.append(make("div", { className: "joint" }, make("span", { title: joint.name }, joint.name), slider, value));
      });
    });
    once();
    return box;
  }
}
