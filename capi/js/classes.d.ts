
/** What holds an object of the library: a Model, a Data, or an object that a function fills. */
export interface Handle {
  pointer: number;
}

export class DynError extends Error {
  /** "DYN_ERROR_ARGUMENT", ... */
  readonly status: string;
}

export class Model implements Handle {
  pointer: number;
  readonly dyn: Dyn;
  readonly nq: number;
  readonly nv: number;
  readonly njoints: number;
  readonly nframes: number;
  readonly nbodies: number;
  readonly nshapes: number;
  readonly nactuators: number;
  readonly nu: number;
  readonly nsensors: number;
  readonly nsensordata: number;
  readonly joint_names: string[];
  readonly frame_names: string[];
  readonly configurations: string[];
  neutral(): Float64Array;
  configuration(name: string): Float64Array;
  /** The load report. */
  report(): ReportEntry[];
  data(parts?: number): Data;
  free(): void;
}

export class Data implements Handle {
  pointer: number;
  readonly model: Model;
  readonly dyn: Dyn;
  /** Copies of the state. */
  readonly q: Float64Array;
  readonly v: Float64Array;
  set_state(q: ArrayLike<number>, v?: ArrayLike<number> | null, a?: ArrayLike<number> | null, tau?: ArrayLike<number> | null): void;
  reset(name?: string | null): void;
  set_control(u: ArrayLike<number>): void;
  set_step_options(options: StepOptions): void;
  step(count?: number): void;
  /** A copy of a field of dyn_field_id: a vector, or a matrix row by row. */
  array(name: string): Float64Array;
  forward_kinematics(q?: ArrayLike<number>, v?: ArrayLike<number> | null, a?: ArrayLike<number> | null): void;
  /** X_WF of a frame by id or name: 12 numbers, as in dyn_frame_placement. */
  frame_placement(frame: number | string): Float64Array;
  contacts(): ContactForce[];
  report(): StepReport;
  free(): void;
}

export interface Dyn extends Enumerations {
  readonly version: string;
  readonly build_info: string;
  readonly c: Functions;
  /** A robot or scene: text of URDF or MJCF, or bytes of a .dynb file. */
  model(content: string | Uint8Array, options?: LoadOptions): Model;
  /** Writes a file of the module's own file system. */
  write_file(path: string, content: string | Uint8Array): void;
  load_file(path: string, options?: LoadOptions): Model;
  /** The library's memory as numbers from an address on, until it grows. */
  numbers(address: number): Float64Array;
}

/** Compiles the module. options are Emscripten's: wasmBinary, locateFile, ... */
export function load(options?: object): Promise<Dyn>;
