// One state of a running simulation, as dyn view --live sends it: little-endian floats, in the order of live/simulation.cpp.
export function parseState(buffer, model) {
  const x = new Float32Array(buffer);
  const joints = model.joints.length - 1;
  let at = 10;
  const take = (n) => x.subarray(at, (at += n));
  const [time, paused, speed, rate, kinetic, potential, residual, penetration, step, count] = x;
  const state = {
    time,
    paused: paused !== 0,
    speed,
    rate,
    kinetic,
    potential,
    residual,
    penetration,
    step,
    positions: take(3 * joints),
    turns: take(4 * joints),
    com: take(3),
    q: take(model.nq),
    v: take(model.nv)
  };
  const moves = (shape) => model.frames[model.shapes[shape].frame].joint !== 0;
  state.contacts = Array.from({ length: count }, () => {
    const c = take(9), sign = moves(c[8]) ? 1 : -1; // the force on what moves
    return {
      position: c.subarray(0, 3),
      force: [sign * c[3], sign * c[4], sign * c[5]],
      distance: c[6],
      a: c[7],
      b: c[8],
      on: sign > 0 ? c[8] : c[7]
    };
  });
  state.tendons = x.subarray(at);
  return state;
}
