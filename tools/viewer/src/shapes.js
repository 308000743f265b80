// Geometry of each kind of shape, in the shape's frame, as dyn.h describes it.
import * as THREE from "three";

const upright = (geometry) => geometry.rotateX(Math.PI / 2); // three's y axis is our z

export function matrixOf(placement) {
  const [a, b, c, d, e, f, g, h, i, x, y, z] = placement;
  return new THREE.Matrix4().set(a, d, g, x, b, e, h, y, c, f, i, z, 0, 0, 0, 1);
}

const NO_COLOUR = 0xb0bac6; // of triangles of a file whose others have one

export function surface(mesh, read) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(read(mesh.vertices), 3));
  geometry.setIndex(new THREE.BufferAttribute(read(mesh.triangles), 1));
  const flat = geometry.toNonIndexed(); // robots have edges
  flat.computeVertexNormals();
  if (mesh.palette) {
    const palette = mesh.palette.map((colour) => new THREE.Color(colour ?? NO_COLOUR));
    const which = mesh.colours && read(mesh.colours), rgb = new Float32Array(flat.attributes.position.array.length);
    for (let corner = 0; corner < rgb.length / 3; ++corner) {
      const { r, g, b } = palette[which ? which[Math.floor(corner / 3)] : 0];
      rgb.set([r, g, b], 3 * corner);
    }
    flat.setAttribute("color", new THREE.BufferAttribute(rgb, 3));
  }
  return flat;
}

// Corners of radius r around a box of half sizes h: a box of 9 x 9 x 9 facets, of which 8 along each edge are bent.
function roundedBox(h, r) {
  const geometry = new THREE.BoxGeometry(1, 1, 1, 9, 9, 9);
  const { position, normal } = geometry.attributes;
  for (let k = 0; k < position.count; ++k) {
    const p = [0, 1, 2].map((i) => position.array[3 * k + i]);
    const n = p.map((x) => x - Math.sign(x) / 18);
    const length = Math.hypot(...n);
    for (let i = 0; i < 3; ++i) {
      normal.array[3 * k + i] = n[i] / length;
      position.array[3 * k + i] = Math.sign(p[i]) * h[i] + (r * n[i]) / length;
    }
  }
  return geometry;
}

function capsule(r, length) {
  const arc = (from, y) => Array.from({ length: 11 }, (_, k) => from + (k * Math.PI) / 20)
                             .map((a) => new THREE.Vector2(r * Math.cos(a), y + r * Math.sin(a)));
  return new THREE.LatheGeometry([...arc(-Math.PI / 2, -length / 2), ...arc(0, length / 2)], 28);
}

/** @returns {THREE.BufferGeometry | null} null: there is nothing to draw */
export function geometryOf(shape, meshes) {
  const [x, y, z] = shape.size;
  const r = shape.radius;
  switch (shape.type) {
    case "box":
      return r > 0 ? roundedBox([x / 2, y / 2, z / 2], r) : new THREE.BoxGeometry(x, y, z);
    case "sphere":
      return new THREE.SphereGeometry(x + r, 32, 20);
    case "cylinder":
      return upright(new THREE.CylinderGeometry(x + r, x + r, y + 2 * r, 40));
    case "capsule":
      return upright(capsule(x + r, y));
    case "cone":
      return upright(new THREE.ConeGeometry(x + r, y + 2 * r, 40));
    case "ellipsoid":
      return new THREE.SphereGeometry(1, 36, 24).scale(x + r, y + r, z + r);
    default:
      return shape.mesh === undefined ? null : meshes[shape.mesh];
  }
}
