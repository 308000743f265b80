// Geometry of each kind of shape, in the shape's frame, as dyn.h describes it.
import * as THREE from "three";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";

const upright = (geometry) => geometry.rotateX(Math.PI / 2); // three's y axis is our z

export function matrixOf(placement) {
  const [a, b, c, d, e, f, g, h, i, x, y, z] = placement;
  return new THREE.Matrix4().set(a, d, g, x, b, e, h, y, c, f, i, z, 0, 0, 0, 1);
}

export function surface(mesh, read) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(read(mesh.vertices), 3));
  geometry.setIndex(new THREE.BufferAttribute(read(mesh.triangles), 1));
  const flat = geometry.toNonIndexed(); // robots have edges
  flat.computeVertexNormals();
  return flat;
}

/** @returns {THREE.BufferGeometry | null} null: there is nothing to draw */
export function geometryOf(shape, meshes) {
  const [x, y, z] = shape.size;
  const r = shape.radius;
  switch (shape.type) {
    case "box":
      return r > 0 ? new RoundedBoxGeometry(x + 2 * r, y + 2 * r, z + 2 * r, 4, r) : new THREE.BoxGeometry(x, y, z);
    case "sphere":
      return new THREE.SphereGeometry(x + r, 32, 20);
    case "cylinder":
      return upright(new THREE.CylinderGeometry(x + r, x + r, y + 2 * r, 40));
    case "capsule":
      return upright(new THREE.CapsuleGeometry(x + r, y, 10, 28));
    case "cone":
      return upright(new THREE.ConeGeometry(x + r, y + 2 * r, 40));
    case "ellipsoid":
      return new THREE.SphereGeometry(1, 36, 24).scale(x + r, y + r, z + r);
    default:
      return shape.mesh === undefined ? null : meshes[shape.mesh];
  }
}
