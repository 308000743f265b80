// Joints moved by hand: where everything then is.
import * as THREE from "three";
import { make, number, section } from "./dom.js";
import { chainOf, knobsOf, motionOf } from "./joints.js";
import { matrixOf } from "./shapes.js";

export class Kinematics {
  constructor(robot, q) {
    this.robot = robot;
    this.q = Float64Array.from(q);
    this.joints = robot.model.joints;
    this.chains = this.joints.map(chainOf);
    // from each joint's parent to it, as it stands
    this.still = robot.joints.map((node, id) => {
      node.updateMatrix();
      const parent = robot.joints[this.joints[id].parent];
      return id ? parent.matrix.clone().invert().multiply(node.matrix) : new THREE.Matrix4();
    });
  }

  #coordinates(joint) {
    if (joint.mimic) return [joint.mimic.ratio * this.q[this.joints[joint.mimic.leader].q] + joint.mimic.offset];
    return this.q.subarray(joint.q, joint.q + joint.nq);
  }

  apply() {
    const world = this.joints.map(() => new THREE.Matrix4());
    this.joints.forEach((joint, id) => {
      if (!id) return;
      const relative = this.chains[id].length ?
        matrixOf(joint.chain?.rest ?? joint.placement).multiply(motionOf(this.chains[id], this.#coordinates(joint))) :
        this.still[id];
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

  /** a slider for each direction of each */
  panel(onChange) {
    const { box, once } = section("joints", "rad, m; drag to move", true, (element) => {
      this.joints.forEach((joint, id) => {
        if (!id || joint.mimic) return;
        const q = this.q.subarray(joint.q, joint.q + joint.nq), knobs = knobsOf(this.chains[id], q, joint.lower, joint.upper);
        knobs.forEach((knob, k) => {
          const name = knobs.length > 1 ? `${joint.name}[${k}] ${knob.kind}` : joint.name;
          const value = make("span", { className: "number" }, number(knob.value, 3));
          const slider = make("input", {
            type: "range", step: "any", "aria-label": name,
            // where a value is beyond its limits, so is its slider
            min: Math.min(knob.min, knob.value), max: Math.max(knob.max, knob.value), value: knob.value,
            oninput: () => {
              knob.move(Number(slider.value), q);
              value.textContent = number(Number(slider.value), 3);
              this.apply();
              onChange();
            },
          });
          slider.dataset.joint = joint.name;
          element.append(make("div", { className: "joint" }, make("span", { title: name }, name), slider, value));
        });
      });
    });
    once();
    return box;
  }
}
