// Joints as chains of simple motions, as in src/joint: the coordinates that each takes, and the sliders that move it.
import * as THREE from "three";

const X = new THREE.Vector3(1, 0, 0), Y = new THREE.Vector3(0, 1, 0), Z = new THREE.Vector3(0, 0, 1);
const FREE = { turn: Math.PI, shift: 1 }; // how far a slider goes from where it stands, where there is no limit: rad, m

const shifted = (axis, by) => new THREE.Matrix4().makeTranslation(by * axis.x, by * axis.y, by * axis.z);

/** angle about an axis, with pitch along it */
const turn = (axis, pitch = 0) => ({
  nq: 1,
  knobs: ["turn"],
  motion: ([q]) => shifted(axis, pitch * q).multiply(new THREE.Matrix4().makeRotationAxis(axis, q)),
  start: ([q]) => [q],
  coordinates: (x) => x,
});
const shift = (axis) => ({ ...turn(axis), knobs: ["shift"], motion: ([q]) => shifted(axis, q) });
/** cosine and sine of an angle */
const circle = (axis) => ({
  nq: 2,
  knobs: ["turn"],
  motion: ([c, s]) => new THREE.Matrix4().makeRotationAxis(axis, Math.atan2(s, c)),
  start: ([c, s]) => [Math.atan2(s, c)],
  coordinates: ([x]) => [Math.cos(x), Math.sin(x)],
});
/** a quaternion; its sliders are the rotation vector, in the child's frame, from where it stood */
const ball = {
  nq: 4,
  knobs: ["turn", "turn", "turn"],
  motion: (q) => new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion(...q)),
  start: () => [0, 0, 0],
  coordinates(x, from) {
    const vector = new THREE.Vector3(...x), angle = vector.length();
    return new THREE.Quaternion(...from)
      .multiply(new THREE.Quaternion().setFromAxisAngle(angle ? vector.divideScalar(angle) : X, angle))
      .toArray();
  },
};

const linear = ([x, y, z]) => new THREE.Vector3(x, y, z);
const angular = ([, , , x, y, z]) => new THREE.Vector3(x, y, z);
/** where the constant twist [linear; angular] gets to in time t (Murray, Li, Sastry 1994, 2.36) */
function exponential(twist, t) {
  const v = linear(twist), axis = angular(twist), rate = axis.length();
  if (!rate) return shifted(v, t);
  axis.divideScalar(rate), v.divideScalar(rate);
  const rotation = new THREE.Matrix4().makeRotationAxis(axis, rate * t);
  const about = axis.clone().cross(v); // the axis goes through it
  return rotation.clone().setPosition(
    about.clone().sub(about.clone().applyMatrix4(rotation)).addScaledVector(axis, axis.dot(v) * rate * t));
}

/** what a chain of the command says; see tools/cli/page/chain.hpp */
const PARTS = {
  screw: ([twist]) =>
    ({...turn(X), knobs: [angular(twist).length() ? "turn" : "shift"], motion: ([q]) => exponential(twist, q) }),
  circle: ([twist]) => ({...circle(X), motion: ([c, s]) => exponential(twist, Math.atan2(s, c)) }),
  // its centre p: a twist's linear part is p x its axis
  ball(twists) {
    const axes = twists.map(angular), p = new THREE.Vector3();
    for (const [k, axis] of axes.entries()) p.add(axis.clone().cross(linear(twists[k])).divideScalar(2));
    const at = new THREE.Matrix4().makeBasis(...axes).setPosition(p), back = at.clone().invert();
    return { ...ball, motion: (q) => at.clone().multiply(ball.motion(q)).multiply(back) };
  },
};

/** @returns the chain of a joint; empty: of a type that is left as it stands */
export function chainOf(joint) {
  if (joint.chain) return joint.chain.parts.map(({ kind, twists }) => PARTS[kind](twists));
  const axis = new THREE.Vector3(...joint.axis);
  const inPlane = axis.z > -1 ? new THREE.Quaternion().setFromUnitVectors(Z, axis) : new THREE.Quaternion(1, 0, 0, 0);
  const plane = (e) => e.clone().applyQuaternion(inPlane);
  const axes = { x: X, y: Y, z: Z, axis, axis2: new THREE.Vector3(...joint.axis2), axis_x: plane(X), axis_y: plane(Y) };
  const motions = {
    revolute: (a) => [turn(a)],
    prismatic: (a) => [shift(a)],
    helical: (a) => [turn(a, joint.pitch)],
    revolute_unbounded: (a) => [circle(a)],
    spherical: () => [ball],
    free_flyer: () => [shift(X), shift(Y), shift(Z), ball],
  };
  return joint.motions.split(", ").flatMap((motion) => {
    const [kind, a] = motion.split(" "); // "prismatic axis_x": see dynJointTypeInfo in dyn.h
    return motions[kind]?.(axes[a]) ?? [];
  });
}

/** the chain's motion at its coordinates */
export function motionOf(chain, q) {
  const out = new THREE.Matrix4();
  let at = 0;
  for (const part of chain) out.multiply(part.motion(q.slice(at, (at += part.nq))));
  return out;
}

/** sliders of a chain that stands at q: what each moves, where it stands and may go, and q when it is elsewhere */
export function knobsOf(chain, q, lower, upper) {
  const knobs = [];
  let at = 0;
  for (const part of chain) {
    const first = at, from = Array.from(q.slice(at, (at += part.nq)));
    const x = part.start(from);
    part.knobs.forEach((kind, i) => {
      const bound = (limit, sign) => (part.nq === 1 && Number.isFinite(limit ?? NaN) ? limit : x[i] + sign * FREE[kind]);
      knobs.push({
        kind,
        value: x[i],
        min: bound(lower[first], -1),
        max: bound(upper[first], 1),
        move: (value, all) => ((x[i] = value), part.coordinates(x, from).forEach((c, k) => (all[first + k] = c)))
      });
    });
  }
  return knobs;
}
