// libdyn in WebAssembly: `const dyn = await load()`. dyn.c holds every function of dyn.h by its name; Model and Data are what most programs need.
import dynModule from "./dyn_module.js";
import {Layout} from "./layout.js";
import {Marshal} from "./marshal.js";

export class DynError extends Error {
  constructor(name, message) {
    super(message);
    this.name = "DynError";
    this.status = name; // "DYN_ERROR_ARGUMENT"
  }
}

export class Model {
  constructor(dyn, pointer) {
    Object.assign(this, {dyn, pointer});
    for (const name of ["nq", "nv", "njoints", "nframes", "nbodies", "nshapes", "nactuators", "nu", "nsensors", "nsensordata"])
      this[name] = dyn.c[`dyn_model_${name}`](this);
    this.joint_names = Array.from({length: this.njoints}, (_, k) => dyn.c.dyn_model_joint_name(this, k));
    this.frame_names = Array.from({length: this.nframes}, (_, k) => dyn.c.dyn_model_frame_name(this, k));
    this.configurations = Array.from({length: dyn.c.dyn_model_nconfigurations(this)}, (_, k) => dyn.c.dyn_model_configuration_name(this, k));
  }
  neutral() {
    const q = new Float64Array(this.nq);
    this.dyn.c.dyn_configuration_neutral(this, q);
    return q;
  }
  configuration(name) {
    const q = new Float64Array(this.nq);
    this.dyn.c.dyn_model_configuration(this, name, q);
    return q;
  }
  // Lines of the load report: level, message, ...
  report() {
    return Array.from({length: this.dyn.c.dyn_model_report_count(this)}, (_, k) => {
      const entry = {};
      this.dyn.c.dyn_model_report_entry(this, k, entry);
      return entry;
    });
  }
  data(parts) {
    return new Data(this, parts);
  }
  free() {
    this.dyn.c.dyn_model_free(this);
    this.pointer = 0;
  }
}

export class Data {
  constructor(model, parts = model.dyn.Parts.ALL) {
    this.model = model;
    this.dyn = model.dyn;
    this.pointer = 0;
    this.dyn.c.dyn_data_new(model, parts, this);
  }
  // The state; null leaves a part as it is in C: zeros.
  set_state(q, v = null, a = null, tau = null) {
    this.dyn.c.dyn_data_set_state(this.model, this, q, v, a, tau);
  }
  reset(name = null) {
    this.dyn.c.dyn_data_reset(this.model, this, name);
  }
  set_control(u) {
    this.dyn.c.dyn_data_set_control(this.model, this, u);
  }
  set_step_options(options) {
    const all = {};
    this.dyn.c.dyn_data_step_options(this.model, this, all);
    this.dyn.c.dyn_data_set_step_options(this.model, this, {...all, ...options});
  }
  step(count = 1) {
    for (let k = 0; k < count; ++k) this.dyn.c.dyn_step(this.model, this);
  }
  // A copy of a field: a vector, or a matrix row by row.
  array(name) {
    const field = this.dyn.c.dyn_field_id(name), view = {};
    if (field < 0) throw new TypeError(`there is no field "${name}"`);
    this.dyn.c.dyn_data_array(this.model, this, field, view);
    const {rows, cols, stride, data} = view, all = this.dyn.numbers(data), out = new Float64Array(rows * cols);
    for (let i = 0; i < rows; ++i) for (let j = 0; j < cols; ++j) out[i * cols + j] = all[i * stride[0] + j * stride[1]];
    return out;
  }
  get q() {
    return this.array("q");
  }
  get v() {
    return this.array("v");
  }
  // X_WF of a frame by id or name: rotation by columns and position, 12 numbers. It needs forward_kinematics().
  frame_placement(frame) {
    const id = typeof frame === "string" ? this.dyn.c.dyn_model_frame_id(this.model, frame) : frame, out = new Float64Array(12);
    this.dyn.c.dyn_frame_placement(this.model, this, id, out);
    return out;
  }
  forward_kinematics(q = this.q, v = null, a = null) {
    this.dyn.c.dyn_forward_kinematics(this.model, this, q, v, a);
  }
  // Contact points of the last step with their forces.
  contacts() {
    const count = new Int32Array(1);
    this.dyn.c.dyn_data_step_contacts(this.model, this, null, 0, count);
    const out = Array.from({length: count[0]}, () => ({}));
    if (out.length) this.dyn.c.dyn_data_step_contacts(this.model, this, out, out.length, count);
    return out;
  }
  report() {
    const out = {};
    this.dyn.c.dyn_data_step_report(this.model, this, out);
    return out;
  }
  free() {
    this.dyn.c.dyn_data_free(this);
    this.pointer = 0;
  }
}

class Dyn {
  constructor(module) {
    this.module = module;
    const text = new Marshal(module).text(module._dyn_interface_json());
    const api = JSON.parse(text), layout = new Layout(api), starts = new Map();
    for (const f of api.functions)
      if (f.name.endsWith("_init") && f.parameters.length === 2 && f.parameters[1].name === "struct_size")
        starts.set(f.parameters[0].type.slice(0, -1), f.name);
    this.marshal = new Marshal(module, layout, starts);
    this.status = new Map(api.enums.find((e) => e.name === "dynStatus").values.map((v) => [v.value, v.identifier]));
    this.c = {};
    for (const f of api.functions) this.c[f.name] = f.returns === "dynStatus" ? this.checked(f) : (...values) => this.marshal.call(f, values);
    for (const e of api.enums) this[e.name.slice(3)] = Object.freeze(Object.fromEntries(e.values.map((v) => [v.name, v.value])));
    this.version = this.c.dyn_version();
    this.build_info = this.c.dyn_build_info();
  }
  checked(f) {
    return (...values) => {
      const status = this.marshal.call(f, values);
      if (status) throw new DynError(this.status.get(status), this.c.dyn_last_error());
      return status;
    };
  }
  // The library's memory as numbers from an address on, until it grows.
  numbers(address) {
    return new Float64Array(this.module.HEAPU8.buffer, address);
  }
  // A robot or scene: text of URDF or MJCF, or bytes of a .dynb file. options: members of dynLoadOptions.
  model(content, options = {}) {
    const box = {pointer: 0};
    if (typeof content === "string") this.c.dyn_model_load_string(content, options, box);
    else {
      this.module.FS.writeFile("/model.dynb", content);
      this.c.dyn_model_load("/model.dynb", options, box);
    }
    return new Model(this, box.pointer);
  }
  // A file of the module's own file system, for robots with meshes: write_file("/robot/base.stl", bytes), then load_file("/robot/robot.urdf").
  write_file(path, content) {
    this.module.FS.mkdirTree(path.slice(0, path.lastIndexOf("/")) || "/");
    this.module.FS.writeFile(path, content);
  }
  load_file(path, options = {}) {
    const box = {pointer: 0};
    this.c.dyn_model_load(path, options, box);
    return new Model(this, box.pointer);
  }
}

// In Node.js, whose fetch reads no files, and where Emscripten 3.1 takes names of CommonJS to be there.
async function load_in_node(options) {
  const {createRequire} = await import("node:module"), {readFile} = await import("node:fs/promises");
  const names = {require: createRequire(import.meta.url), __dirname: "."};
  const missing = Object.keys(names).filter((name) => !(name in globalThis));
  for (const name of missing) globalThis[name] = names[name];
  try {
    return await dynModule({wasmBinary: await readFile(new URL("./dyn_module.wasm", import.meta.url)), ...options});
  } finally {
    for (const name of missing) delete globalThis[name];
  }
}

// Compiles the module. options are Emscripten's: wasmBinary, locateFile, ...
export async function load(options = {}) {
  return new Dyn(await (globalThis.process?.versions?.node ? load_in_node(options) : dynModule(options)));
}
