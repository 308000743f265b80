// A simulation that goes on in the page itself: the messages of dyn view --live (tools/viewer/src/live.js), without a server.
import {load} from "./libdyn.js";

const SHARE = 0.8; // of the wall time, at most, goes into steps
const FRAME = 1000 / 60; // ms

// Rotation by columns to a quaternion x, y, z, w (Shepperd 1978: the largest component first).
function quaternion(r) {
  const at = (i, j) => r[i + 3 * j];
  const trace = [at(0, 0) - at(1, 1) - at(2, 2), at(1, 1) - at(2, 2) - at(0, 0), at(2, 2) - at(0, 0) - at(1, 1), at(0, 0) + at(1, 1) + at(2, 2)];
  const k = trace.indexOf(Math.max(...trace)), out = [0, 0, 0, 0];
  out[k] = 1 + trace[k];
  if (k === 3) for (let a = 0; a < 3; ++a) out[a] = at((a + 2) % 3, (a + 1) % 3) - at((a + 1) % 3, (a + 2) % 3);
  else {
    const a = k, b = (k + 1) % 3, c = (k + 2) % 3;
    out[b] = at(a, b) + at(b, a), out[c] = at(c, a) + at(a, c), out[3] = at(c, b) - at(b, c);
  }
  return out.map((x) => x / Math.hypot(...out));
}

// X_WJ = X_WF X_JF^-1, of a frame F that the joint J carries.
function joint_placement(world, local) {
  const r = new Array(9), p = new Array(3);
  for (let i = 0; i < 3; ++i) for (let j = 0; j < 3; ++j) r[i + 3 * j] = world[i] * local[j] + world[i + 3] * local[j + 3] + world[i + 6] * local[j + 6];
  for (let i = 0; i < 3; ++i) p[i] = world[9 + i] - (r[i] * local[9] + r[i + 3] * local[10] + r[i + 6] * local[11]);
  return {r, p};
}

export class Simulation {
  constructor(dyn, text, configuration, options = {}) {
    Object.assign(this, {dyn, configuration, model: dyn.model(text, options), speed: 1, owed: 0, rate: 0, step_us: 0, paused: false});
    const {c} = dyn, frames = new Map();
    for (let f = this.model.nframes - 1; f >= 0; --f) {
      const info = {};
      c.dyn_model_frame_info(this.model, f, info);
      frames.set(info.joint, {id: f, placement: info.placement});
    }
    this.frames = Array.from({length: this.model.njoints - 1}, (_, k) => frames.get(k + 1));
    this.data = this.model.data();
    this.mind = this.model.data(); // where placements are computed
    const step = {};
    c.dyn_data_step_options(this.model, this.data, step);
    this.dt = step.dt;
    this.reset();
  }
  reset() {
    this.data.reset(this.configuration);
    this.time = 0;
  }
  // Steps until it is `wall` seconds further, by the speed asked for.
  go_on(wall) {
    if (this.paused) return;
    const began = performance.now(), spent = () => (performance.now() - began) / 1000;
    let steps = 0;
    for (this.owed += wall * this.speed; this.owed >= this.dt && spent() < SHARE * wall; this.owed -= this.dt, ++steps) this.data.step();
    if (steps) this.step_us = (1e6 * spent()) / steps;
    this.rate = (steps * this.dt) / wall;
    this.time += steps * this.dt;
    if (this.owed >= this.dt) this.owed = 0; // what cannot be kept up with is not made up for
  }
  obey({do: what, on, factor, frame, point, force}) {
    const {c} = this.dyn, {model, data} = this;
    if (what === "pause") this.paused = on;
    else if (what === "reset") this.reset();
    else if (what === "speed") this.speed = Math.min(Math.max(factor, 0.01), 100);
    else if (what === "push") {
      c.dyn_data_clear_wrenches(model, data);
      if (force.some((x) => x !== 0)) c.dyn_data_apply_wrench(model, data, frame, point, [...force, 0, 0, 0], this.dyn.Reference.LOCAL_WORLD_ALIGNED);
    } else throw new Error(`there is no command "${what}"`);
  }
  // As tools/viewer/src/state.js reads it.
  state() {
    const {c} = this.dyn, {model, data, mind} = this, q = data.q, v = data.v, report = data.report(), contacts = data.contacts();
    const kinetic = new Float64Array(1), potential = new Float64Array(1), com = new Float64Array(3);
    c.dyn_energy(model, mind, q, v, kinetic, potential);
    c.dyn_com(model, mind, q, null, null, com, null, null);
    mind.forward_kinematics(q);
    const poses = this.frames.map((f) => joint_placement(mind.frame_placement(f.id), f.placement));
    const numbers = [this.time, Number(this.paused), this.speed, this.rate, kinetic[0], potential[0], report.residual, report.penetration, this.step_us, contacts.length,
      ...poses.flatMap((x) => x.p), ...poses.flatMap((x) => quaternion(x.r)), ...com, ...q, ...v];
    for (const one of contacts) numbers.push(...one.contact.position, ...one.force_on_b, one.contact.distance, one.contact.shape_a, one.contact.shape_b);
    return new Float32Array(numbers).buffer;
  }
}

// Stands for a WebSocket to dyn view --live.
export class LocalSocket {
  constructor(make) {
    this.readyState = 0;
    make().then((simulation) => {
      this.simulation = simulation;
      this.readyState = 1; // WebSocket.OPEN
      this.turn(performance.now());
    }, (error) => this.tell(error));
  }
  tell(error) {
    this.onmessage({data: JSON.stringify({error: error.message})});
  }
  turn(before) {
    const now = performance.now(), {simulation} = this;
    try {
      simulation.go_on(Math.min((now - before) / 1000, 0.1));
      this.onmessage({data: simulation.state()});
    } catch (error) {
      simulation.paused = true;
      this.tell(error);
    }
    setTimeout(() => this.turn(now), FRAME);
  }
  send(text) {
    try {
      this.simulation.obey(JSON.parse(text));
    } catch (error) {
      this.tell(error);
    }
  }
}

// The page holds the module and the robot, each in base64 (page.mjs).
const bytes = (id) => Uint8Array.from(atob(document.getElementById(id).textContent), (x) => x.charCodeAt(0));
if (globalThis.document?.getElementById("dyn-module"))
  globalThis.dynSocket = () => new LocalSocket(async () => {
    const {configuration, options} = JSON.parse(document.getElementById("dyn-start").textContent);
    const dyn = await load({wasmBinary: bytes("dyn-module")});
    return (globalThis.dynSimulation = new Simulation(dyn, new TextDecoder().decode(bytes("dyn-robot")), configuration, options));
  });
