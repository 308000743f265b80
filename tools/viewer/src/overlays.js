// What is drawn beside the robot: frames, centre of mass, inertia ellipsoids, contact points and forces, tendons.
import * as THREE from "three";
import { eigen, semiAxes } from "./inertia.js";

const MOST_CONTACTS = 512;
const CORD = 0x7a5230, SLACK = 0x3b5bc0, PULLS = 0xd1495b; // tendons; muscles without and with activation
const Z = new THREE.Vector3(0, 0, 1);

export class Overlays {
  constructor(robot, scene) {
    this.robot = robot;
    this.scene = scene;
    this.groups = { frames: [], inertia: [], com: [], contacts: [], tendons: [] };
    this.#frames();
    this.#inertia();
    this.#com();
    this.#contacts();
    this.weight = Math.max(robot.model.mass * Math.hypot(...robot.model.gravity), 1e-6);
  }

  show(name, on) {
    for (const item of this.groups[name]) item.visible = on;
    this.scene.redraw();
  }

  #frames() {
    this.robot.model.frames.forEach((frame, id) => {
      const axes = new THREE.AxesHelper(this.scene.size / (frame.type === "JOINT" ? 14 : 22));
      axes.material.depthTest = false;
      axes.renderOrder = 2;
      this.robot.frames[id].add(axes);
      this.groups.frames.push(axes);
    });
  }

  #inertia() {
    const material = new THREE.MeshStandardMaterial({ color: 0x3f8f6b, transparent: true, opacity: 0.45, depthWrite: false });
    const ball = new THREE.SphereGeometry(1, 24, 16);
    this.robot.model.frames.forEach((frame, id) => {
      if (!frame.mass) return;
      const { values, vectors } = eigen(frame.inertia);
      const axes = semiAxes(values, frame.mass);
      const [a, b, c] = [0, 1, 2].map(
        (k) => new THREE.Vector3(vectors[0][k], vectors[1][k], vectors[2][k])
                 .multiplyScalar(Math.max(axes[k], this.scene.size / 500)));
      const mesh = new THREE.Mesh(ball, material);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.makeBasis(a, b, c).setPosition(...frame.com);
      this.robot.frames[id].add(mesh);
      this.groups.inertia.push(mesh);
    });
  }

  #com() {
    const s = this.scene.size;
    this.com = new THREE.Mesh(
      new THREE.SphereGeometry(s / 55, 20, 14),
      new THREE.MeshBasicMaterial({ color: 0x6a3fb5, depthTest: false, transparent: true, opacity: 0.9 }));
    this.com.renderOrder = 3;
    this.scene.overlays.add(this.com);
    this.groups.com.push(this.com);
  }

  #contacts() {
    const s = this.scene.size;
    const red = new THREE.MeshBasicMaterial({ color: 0xd1495b, depthTest: false, transparent: true, opacity: 0.95 });
    const many = (geometry) => {
      const mesh = new THREE.InstancedMesh(geometry, red, MOST_CONTACTS);
      mesh.count = 0;
      mesh.frustumCulled = false;
      mesh.renderOrder = 4;
      this.scene.overlays.add(mesh);
      this.groups.contacts.push(mesh);
      return mesh;
    };
    this.points = many(new THREE.SphereGeometry(s / 160, 10, 8));
    this.shafts = many(new THREE.CylinderGeometry(s / 280, s / 280, 1, 10).rotateX(Math.PI / 2).translate(0, 0, 0.5));
    this.heads = many(new THREE.ConeGeometry(s / 110, s / 40, 14).rotateX(Math.PI / 2));
  }

  /** pieces: 7 numbers each, both ends and the activation of a muscle that pulls, else -1 */
  setTendons(pieces) {
    if (!pieces) return;
    const n = pieces.length / 7, ends = new Float32Array(6 * n), colours = new Float32Array(6 * n), colour = new THREE.Color();
    for (let k = 0; k < n; ++k) {
      ends.set(pieces.subarray(7 * k, 7 * k + 6), 6 * k);
      const activation = pieces[7 * k + 6];
      if (activation < 0) colour.set(CORD);
      else colour.set(SLACK).lerp(new THREE.Color(PULLS), Math.min(activation, 1));
      for (let end = 0; end < 6; end += 3) colour.toArray(colours, 6 * k + end);
    }
    if (!this.groups.tendons.length) {
      const material = new THREE.LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true });
      const lines = new THREE.LineSegments(new THREE.BufferGeometry(), material);
      lines.frustumCulled = false;
      lines.renderOrder = 2;
      this.scene.overlays.add(lines);
      this.groups.tendons.push(lines);
    }
    const [lines] = this.groups.tendons;
    lines.geometry.dispose();
    lines.geometry = new THREE.BufferGeometry();
    lines.geometry.setAttribute("position", new THREE.BufferAttribute(ends, 3));
    lines.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  }

  setCom(x, y, z) {
    this.com.position.set(x, y, z);
  }

  /** contacts: [{position, force}]: the force on what moves, drawn as long as the robot for one and a half times its weight */
  setContacts(contacts) {
    const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1);
    const force = new THREE.Vector3(), at = new THREE.Vector3(), scale = new THREE.Vector3();
    const n = Math.min(contacts.length, MOST_CONTACTS);
    for (let k = 0; k < n; ++k) {
      at.fromArray(contacts[k].position);
      force.fromArray(contacts[k].force);
      const length = (force.length() / this.weight) * this.scene.size * 0.67;
      turn.setFromUnitVectors(Z, force.lengthSq() > 0 ? force.normalize() : Z);
      this.points.setMatrixAt(k, matrix.compose(at, turn, one));
      this.shafts.setMatrixAt(k, matrix.compose(at, turn, scale.set(1, 1, Math.max(length, 1e-9))));
      this.heads.setMatrixAt(
        k,
        matrix.compose(at.addScaledVector(force, length), turn, length > 1e-3 * this.scene.size ? one : scale.setScalar(1e-6)));
    }
    for (const mesh of [this.points, this.shafts, this.heads]) {
      mesh.count = n;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }
}
