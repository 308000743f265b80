// Where the members of dyn.h's structs lie in memory, by the rules of C on wasm32. `api` is what dyn_interface_json returns.

const SCALARS = {
  double: {size: 8, get: "getFloat64", set: "setFloat64"},
  int: {size: 4, get: "getInt32", set: "setInt32"},
  int32_t: {size: 4, get: "getInt32", set: "setInt32"},
  uint32_t: {size: 4, get: "getUint32", set: "setUint32"},
  size_t: {size: 4, get: "getUint32", set: "setUint32"},
  ptrdiff_t: {size: 4, get: "getInt32", set: "setInt32"},
  uint16_t: {size: 2, get: "getUint16", set: "setUint16"},
  uint8_t: {size: 1, get: "getUint8", set: "setUint8"},
  char: {size: 1, get: "getInt8", set: "setInt8"},
  int64_t: {size: 8, get: "getBigInt64", set: "setBigInt64", big: true},
  uint64_t: {size: 8, get: "getBigUint64", set: "setBigUint64", big: true},
};
const POINTER = SCALARS.uint32_t;
const ARRAYS = {
  double: Float64Array, int: Int32Array, int32_t: Int32Array, uint32_t: Uint32Array, size_t: Uint32Array, int64_t: BigInt64Array,
  uint64_t: BigUint64Array, void: Uint8Array, uint8_t: Uint8Array, char: Uint8Array,
};

export class Layout {
  constructor(api) {
    this.enums = new Map(api.enums.map((e) => [e.name, e]));
    this.aliases = new Map(api.types.map((t) => [t.name, t.type]));
    this.declared = new Map(api.structs.map((s) => [s.name, s]));
    this.structs = new Map();
  }

  // The base of an alias or enumeration, without const.
  plain(type) {
    const bare = type.replace(/^const /, "");
    if (this.enums.has(bare)) return "int";
    return this.aliases.has(bare) ? this.plain(this.aliases.get(bare)) : bare;
  }

  scalar(type) {
    return type.endsWith("*") ? POINTER : SCALARS[this.plain(type)];
  }

  // The array of numbers that a pointer to them, or an array of C, is in JavaScript.
  array(type) {
    return ARRAYS[this.plain(type.replace(/\*$/, ""))];
  }

  struct(name) {
    const key = name.replace(/^const /, "");
    if (!this.structs.has(key) && this.declared.has(key)) this.structs.set(key, this.laid_out(this.declared.get(key)));
    return this.structs.get(key);
  }

  laid_out(declared) {
    let end = 0, align = 1;
    const fields = declared.fields.map((field) => {
      const inner = field.type && this.struct(field.type);
      const one = field.type ? inner || this.scalar(field.type) : POINTER;
      const boundary = inner ? inner.align : one.size;
      const offset = Math.ceil(end / boundary) * boundary;
      const count = (field.length || []).reduce((a, b) => a * b, 1);
      end = offset + one.size * count;
      align = Math.max(align, boundary);
      return {name: field.name, type: field.type || "void*", offset, count, many: Boolean(field.length), struct: inner, scalar: inner ? null : one};
    });
    return {name: declared.name, size: Math.ceil(end / align) * align, align, fields};
  }
}
