// The npm package in Node.js:  DYN_JS=FOLDER node --test capi/js/test     FOLDER: the package as it is built
import assert from "node:assert/strict";
import {readFile} from "node:fs/promises";
import {join} from "node:path";
import {test} from "node:test";
import {pathToFileURL} from "node:url";

const folder = process.env.DYN_JS;
const {load, DynError} = await import(pathToFileURL(join(folder, "libdyn.js")));
const dyn = await load();
const scenes = new URL("../../../models/scenes/", import.meta.url);
const near = (a, b, tolerance) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b} within ${tolerance}`);

const mass = 2, length = 0.7, inertia = 0.01;
const pendulum = `<robot name="pendulum"><link name="world"/><link name="bob"><inertial><origin xyz="0 0 ${-length}"/><mass value="${mass}"/>
  <inertia ixx="${inertia}" iyy="${inertia}" izz="${inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="world"/><child link="bob"/><axis xyz="0 1 0"/></joint></robot>`;

test("inverse dynamics of a pendulum is its closed form", () => {
  const model = dyn.model(pendulum, {base: dyn.Base.FIXED}), data = model.data(), tau = new Float64Array(1);
  assert.deepEqual([model.nq, model.nv, model.joint_names[1]], [1, 1, "hinge"]);
  const q = 0.4, a = 1.5;
  dyn.c.dyn_rnea(model, data, [q], [0.3], [a], null, tau);
  near(tau[0], (mass * length ** 2 + inertia) * a + mass * 9.81 * length * Math.sin(q), 1e-14 * mass * 9.81);
  near(data.array("tau")[0], tau[0], 0);
  data.free();
  model.free();
  assert.throws(() => model.data(), TypeError);
});

test("steps conserve the energy of a pendulum to the integrator's order", () => {
  const model = dyn.model(pendulum, {base: dyn.Base.FIXED});
  const energy = (q, v) => 0.5 * (mass * length ** 2 + inertia) * v ** 2 - mass * 9.81 * length * Math.cos(q);
  const drift = (dt) => {
    const data = model.data();
    data.set_step_options({dt, integrator: dyn.Integrator.RK4});
    data.set_state([1], [0]);
    data.step(Math.round(1 / dt));
    return Math.abs(energy(data.q[0], data.v[0]) - energy(1, 0));
  };
  const ratio = drift(0.02) / drift(0.01);
  assert.ok(ratio > 2 ** 4 && ratio < 2 ** 6, `the drift falls by ${ratio} when the step is halved`);
});

test("a quadruped stands", async () => {
  const model = dyn.model(await readFile(new URL("go2_stands.xml", scenes), "utf8")), data = model.data();
  data.reset("standing");
  const height = data.q[2];
  for (let k = 0; k < 500; ++k) data.step();
  near(data.q[2], height, 0.02);
  const weight = dyn.c.dyn_model_total_mass(model) * 9.81;
  const lift = data.contacts().reduce((sum, c) => sum + c.force_on_b[2] * (c.contact.shape_b === 0 ? -1 : 1), 0);
  near(Math.abs(lift), weight, 0.05 * weight);
});

test("errors say what and where", () => {
  assert.throws(() => dyn.model("<robot name='r'>"), (e) => e instanceof DynError && e.status === "DYN_ERROR_PARSE");
  const model = dyn.model(pendulum, {base: dyn.Base.FIXED});
  assert.throws(() => model.configuration("nowhere"), /nowhere/);
  assert.throws(() => dyn.c.dyn_model_nq(), /takes 1 values \(model\)/);
  assert.throws(() => model.data().set_step_options({step: 1}), /no member step/);
});

test("meshes come from the module's files", () => {
  const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[1, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]];
  dyn.write_file("/robot/tetrahedron.obj", [...corners.map((c) => `v ${c.join(" ")}`), ...faces.map((f) => `f ${f.join(" ")}`)].join("\n"));
  const mesh = {pointer: 0}, info = {};
  dyn.c.dyn_mesh_load("/robot/tetrahedron.obj", null, mesh);
  dyn.c.dyn_mesh_info(mesh, info);
  near(info.volume, 1 / 6, 1e-15);
});

test("a state that is restored goes on with the same bits", async () => {
  const model = dyn.model(await readFile(new URL("go2_stands.xml", scenes), "utf8")), data = model.data();
  data.reset("standing");
  const memory = new Uint8Array(dyn.c.dyn_model_state_size(model));
  data.step(10);
  dyn.c.dyn_data_save_state(model, data, memory, memory.length);
  data.step(50);
  const q = data.q;
  dyn.c.dyn_data_restore_state(model, data, memory, memory.length);
  data.step(50);
  assert.deepEqual(data.q, q);
});
