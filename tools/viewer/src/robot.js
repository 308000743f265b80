// The robot: a node for each joint, moved by poses; below it a node for each frame, with its shapes.
import * as THREE from "three";
import { geometryOf, matrixOf, surface } from "./shapes.js";

const PALETTE = [0x8fa3b8, 0x5b7fa6, 0xb0bac6, 0x6d8f8a, 0x9a8fb0, 0x7d93a8];

/** how a shape looks as a visual one: as the robot's file says, else that of its mesh, else by its joint */
function looks({ rgba }, geometry, joint) {
  const vertexColors = !rgba && geometry.attributes.color !== undefined;
  if (!rgba)
    return {
      color: vertexColors ? 0xffffff :
        joint             ? PALETTE[joint % PALETTE.length] :
                            0xc9ced6,
      vertexColors,
      transparent: false,
      opacity: 1,
      depthWrite: true
    };
  const [r, g, b] = rgba.map((x) => Math.round(255 * x));
  return { color: (r << 16) | (g << 8) | b, transparent: rgba[3] < 1, opacity: rgba[3], depthWrite: rgba[3] === 1 };
}

export class Robot {
  constructor(model, read) {
    this.model = model;
    this.root = new THREE.Group();
    this.joints = model.joints.map((joint) => {
      const node = new THREE.Group();
      node.name = joint.name;
      this.root.add(node);
      return node;
    });
    this.frames = model.frames.map((frame) => {
      const node = new THREE.Group();
      node.matrixAutoUpdate = false;
      node.matrix.copy(matrixOf(frame.placement));
      this.joints[frame.joint].add(node);
      return node;
    });
    this.layers = { visual: [], collision: [], skeleton: [] };
    this.pickable = [];
    this.planes = [];
    const meshes = model.meshes.map((mesh) => surface(mesh, read));
    for (const shape of model.shapes) this.#add(shape, meshes);
    this.hasVisual = this.layers.visual.length > 0;
    this.#skeleton();
  }

  #add(shape, meshes) {
    if (shape.type === "half_space") {
      this.planes.push(shape);
      return;
    }
    const geometry = geometryOf(shape, meshes);
    if (!geometry) return;
    const joint = this.model.frames[shape.frame].joint;
    const look = looks(shape, geometry, joint);
    const material = shape.visual
      ? new THREE.MeshStandardMaterial({ ...look, roughness: 0.6, metalness: 0.1 })
      : new THREE.MeshStandardMaterial({ color: 0xe8a13a, transparent: true, opacity: 0.45, roughness: 0.8, depthWrite: false });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(matrixOf(shape.placement));
    mesh.castShadow = shape.visual && material.opacity > 0.5;
    mesh.userData = { frame: shape.frame, looks: look };
    this.frames[shape.frame].add(mesh);
    this.layers[shape.visual ? "visual" : "collision"].push(mesh);
    this.pickable.push(mesh);
  }

  // Collision shapes in the looks of visual ones, where there are no visual ones.
  drawCollisionAsVisual() {
    for (const mesh of this.layers.collision) {
      mesh.material.setValues(mesh.userData.looks);
      mesh.material.needsUpdate = true;
      mesh.castShadow = mesh.userData.looks.opacity > 0.5;
    }
  }

  #skeleton() {
    const material = new THREE.LineBasicMaterial({ color: 0x30507a, depthTest: false, transparent: true }); // seen through shapes
    this.model.joints.forEach((joint, id) => {
      if (id === 0 || joint.parent === 0) return;
      const end = new THREE.Vector3().setFromMatrixPosition(matrixOf(joint.placement));
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), end]), material);
      this.joints[joint.parent].add(line);
      this.layers.skeleton.push(line);
    });
  }

  show(layer, on) {
    for (const item of this.layers[layer]) item.visible = on;
  }

  /** positions: 3, turns: quaternion, for each joint but the universe */
  setPoses(positions, turns) {
    for (let j = 1; j < this.joints.length; ++j) {
      const node = this.joints[j];
      const p = 3 * (j - 1), t = 4 * (j - 1);
      node.position.set(positions[p], positions[p + 1], positions[p + 2]);
      node.quaternion.set(turns[t], turns[t + 1], turns[t + 2], turns[t + 3]).normalize();
    }
    this.root.updateMatrixWorld(true);
  }

  /** The box that holds what is drawn of the robot itself, the world's own shapes left out. */
  box() {
    const box = new THREE.Box3();
    const one = new THREE.Box3();
    for (const mesh of this.pickable)
      if (this.model.frames[mesh.userData.frame].joint) box.union(one.setFromObject(mesh));
    for (const joint of this.joints.slice(1)) box.expandByPoint(new THREE.Vector3().setFromMatrixPosition(joint.matrixWorld));
    if (box.isEmpty()) box.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
    return box;
  }
}
