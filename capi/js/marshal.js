// Arguments of dyn.h's functions: numbers, text, arrays and objects in, results copied back.

const text_in = new TextEncoder(), text_out = new TextDecoder();

export class Marshal {
  constructor(module, layout, starts) {
    Object.assign(this, {module, layout, starts}); // starts: the function that fills a struct with its defaults, by the struct's name
  }

  get memory() {
    return this.module.HEAPU8.buffer; // another one after the memory has grown
  }
  get view() {
    return new DataView(this.memory);
  }

  text(pointer) {
    if (!pointer) return null;
    const bytes = this.module.HEAPU8;
    return text_out.decode(bytes.slice(pointer, bytes.indexOf(0, pointer)));
  }

  // Calls a function of dyn.h with values of JavaScript.
  call(declared, values) {
    if (values.length !== declared.parameters.length)
      throw new TypeError(`${declared.name} takes ${declared.parameters.length} values (${declared.parameters.map((p) => p.name).join(", ")}), not ${values.length}`);
    const frame = {blocks: [], back: []};
    try {
      const words = declared.parameters.map((p, k) => this.argument(p, values[k], frame, declared.name));
      const result = this.module[`_${declared.name}`](...words);
      for (const copy of frame.back) copy();
      return declared.returns === "const char*" ? this.text(result) : result;
    } finally {
      for (const block of frame.blocks) this.module._free(block);
    }
  }

  allocate(bytes, frame) {
    const block = this.module._malloc(Math.max(bytes, 8));
    if (!block) throw new RangeError(`no memory for ${bytes} bytes`);
    frame.blocks.push(block);
    return block;
  }

  argument(p, value, frame, where) {
    if (p.returns) return value || 0; // a function
    const pointer = p.type.endsWith("*") || Boolean(p.length);
    if (!pointer) return this.number(p.type, value, `${where}: ${p.name}`);
    const of = p.length ? p.type : p.type.slice(0, -1).trim();
    return this.pointer(of, value, frame, `${where}: ${p.name}`);
  }

  number(type, value, where) {
    const big = this.layout.scalar(type)?.big;
    if (typeof value === "boolean") value = Number(value);
    if (typeof value !== "number" && typeof value !== "bigint") throw new TypeError(`${where} is ${String(value)}, but must be a number`);
    return big ? BigInt(value) : Number(value);
  }

  // The address of a value, in C of type "of*".
  pointer(of, value, frame, where) {
    if (value === null || value === undefined) return 0;
    if (typeof value === "number") return value;
    if (/^dyn\w+\*$/.test(of.replace(/^const /, ""))) return this.box(value, frame); // dynModel**
    if (value.pointer !== undefined) return this.handle(value, where);
    if (of === "const char") return this.text_of(value, frame, where);
    if (of === "const char* const") return this.texts(value, frame, where);
    const struct = this.layout.struct(of);
    if (struct) return this.objects(struct, value, frame, !of.startsWith("const "), where);
    return this.numbers(of, value, frame, where);
  }

  handle(value, where) {
    if (!value.pointer) throw new TypeError(`${where} was freed`);
    return value.pointer;
  }

  box(value, frame) {
    const at = this.allocate(4, frame);
    this.view.setUint32(at, 0, true);
    frame.back.push(() => { value.pointer = this.view.getUint32(at, true); });
    return at;
  }

  text_of(value, frame, where) {
    if (typeof value !== "string") throw new TypeError(`${where} is ${String(value)}, but must be a string`);
    const bytes = text_in.encode(value), at = this.allocate(bytes.length + 1, frame);
    this.module.HEAPU8.set(bytes, at);
    this.module.HEAPU8[at + bytes.length] = 0;
    return at;
  }

  texts(values, frame, where) {
    const addresses = Array.from(values, (v) => this.text_of(v, frame, where)), at = this.allocate(4 * addresses.length, frame);
    new Uint32Array(this.memory, at, addresses.length).set(addresses);
    return at;
  }

  numbers(of, value, frame, where) {
    const kind = this.layout.array(of);
    if (!kind || typeof value.length !== "number") throw new TypeError(`${where} must be an array of numbers`);
    if (value.buffer === this.memory) return value.byteOffset; // a view of the library's own memory
    const at = this.allocate(value.length * kind.BYTES_PER_ELEMENT, frame);
    new kind(this.memory, at, value.length).set(value);
    if (of.startsWith("const ")) return at;
    frame.back.push(() => {
      const now = new kind(this.memory, at, value.length);
      for (let k = 0; k < value.length; ++k) value[k] = now[k];
    });
    return at;
  }

  // One object, or an array of them.
  objects(struct, value, frame, back, where) {
    const list = Array.isArray(value) ? value : [value], at = this.allocate(struct.size * list.length, frame);
    this.module.HEAPU8.fill(0, at, at + struct.size * list.length);
    list.forEach((one, k) => this.write(struct, at + k * struct.size, one, frame, where));
    if (back) frame.back.push(() => list.forEach((one, k) => this.read(struct, at + k * struct.size, one)));
    return at;
  }

  write(struct, at, value, frame, where) {
    const start = this.starts.get(struct.name), known = new Set(struct.fields.map((f) => f.name));
    for (const name of Object.keys(value)) if (!known.has(name)) throw new TypeError(`${where}: ${struct.name} has no member ${name}; it has ${[...known].join(", ")}`);
    if (start) this.module[`_${start}`](at, struct.size);
    for (const field of struct.fields) {
      const given = value[field.name], place = at + field.offset, here = `${where}.${field.name}`;
      if (field.name === "struct_size") this.view.setUint32(place, struct.size, true);
      else if (given === undefined || given === null) continue;
      else if (field.struct) [given].flat().forEach((one, k) => this.write(field.struct, place + k * field.struct.size, one, frame, here));
      else if (field.many) [...given].forEach((x, k) => this.set(field, place + k * field.scalar.size, x, here));
      else if (field.type.endsWith("*")) this.view.setUint32(place, this.pointer(field.type.slice(0, -1).trim(), given, frame, here), true);
      else this.set(field, place, given, here);
    }
  }

  set(field, place, value, where) {
    const word = field.type.endsWith("*") ? Number(value) : this.number(field.type, value, where);
    this.view[field.scalar.set](place, word, true);
  }

  read(struct, at, into = {}) {
    for (const field of struct.fields) {
      const place = at + field.offset, many = (one, size) => Array.from({length: field.count}, (_, k) => one(place + k * size));
      if (field.struct) {
        const one = (p) => this.read(field.struct, p);
        into[field.name] = field.many ? many(one, field.struct.size) : one(place);
      } else {
        const one = (p) => (field.type === "const char*" ? this.text(this.view.getUint32(p, true)) : this.view[field.scalar.get](p, true));
        if (field.type.endsWith("*") && field.type !== "const char*" && typeof into[field.name] === "object" && into[field.name]) continue; // the caller's arrays
        into[field.name] = field.many ? many(one, field.scalar.size) : one(place);
      }
    }
    return into;
  }
}
