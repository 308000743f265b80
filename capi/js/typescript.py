#!/usr/bin/env python3
"""Writes the TypeScript types of the npm package from dyn.h: enumerations, structs, every function.   typescript.py DYN_H CLASSES OUT

CLASSES: the types of what libdyn.js adds (classes.d.ts).
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src/table"))
from reflect import Header  # noqa: E402

ARRAYS = {"double": "Float64Array", "int": "Int32Array", "int32_t": "Int32Array", "uint32_t": "Uint32Array", "size_t": "Uint32Array",
          "int64_t": "BigInt64Array", "uint64_t": "BigUint64Array", "void": "Uint8Array", "uint8_t": "Uint8Array"}
RESERVED = {"with", "in", "default", "function", "new", "var", "class", "enum", "case"}


class Types:
    def __init__(self, header):
        self.header = header
        self.structs = {s["name"] for s in header.structs}
        self.enums = {e["name"] for e in header.enums}
        self.handles = {h["name"] for h in header.handles}
        self.aliases = {t["name"]: t["type"] for t in header.types}

    def plain(self, name):
        name = self.aliases.get(name, name)
        return "int" if name in self.enums else name

    def pointer(self, of):
        """What stands for an address of `of`: arrays, text, objects."""
        bare, constant = re.sub(r"^const ", "", of), of.startswith("const ")
        if bare == "char* const":
            return "ReadonlyArray<string>"
        if bare.endswith("*"):  # a box for a new handle
            return "Handle" if bare[:-1] in self.handles else "number"
        if bare in self.handles:
            return "Handle"
        if bare in self.structs:
            return f"{bare[3:]} | {bare[3:]}[]"
        if bare == "char":
            return "string" if constant else "Uint8Array"
        array = ARRAYS.get(self.plain(bare), "Uint8Array")
        scalar = "bigint" if array.startswith("Big") else "number"
        return f"ArrayLike<{scalar}>" if constant else f"{array} | {scalar}[]" if scalar == "number" else array

    def value(self, item, field=False):
        if "returns" in item:
            return "number"
        kind = item["type"]
        if field and "length" in item:
            bare = re.sub(r"^const ", "", kind)
            return f"{bare[3:]}[]" if bare in self.structs else "ArrayLike<number>"
        if "length" in item or kind.endswith("*"):
            of = kind if "length" in item else kind[:-1].strip()
            return f"{self.pointer(of)} | null" + (" | number" if kind.endswith("*") and "char" not in kind else "")
        bare = re.sub(r"^const ", "", kind)
        if bare in self.structs:
            return bare[3:]
        return "number | bigint" if self.plain(bare) in ("int64_t", "uint64_t") else "number"

    def result(self, kind):
        return {"void": "void", "const char*": "string | null"}.get(kind, "bigint" if kind in ("int64_t", "uint64_t") else "number")


def sentence(text, indent=""):
    return f"{indent}/** {' '.join(text.split())} */\n".replace("*/ */", "*/") if text and "*/" not in text else ""


def written(header):
    types = Types(header)
    yield "// Made of dyn.h by capi/js/typescript.py.\n"
    for enum in header.enums:
        yield sentence(enum["doc"])
        values = "".join(f"{sentence(v['doc'], '  ')}  readonly {v['name']}: {v['value']};\n" for v in enum["values"])
        yield f"export interface {enum['name'][3:]}Values {{\n{values}}}\n"
    for struct in header.structs:
        yield sentence(struct["doc"])
        yield f"export interface {struct['name'][3:]} {{\n"
        yield from (f"{sentence(f['doc'], '  ')}  {f['name']}?: {types.value(f, field=True)};\n" for f in struct["fields"] if f["name"] != "struct_size")
        yield "}\n"
    yield "/** Every function of dyn.h. One that returns dynStatus throws DynError instead. */\nexport interface Functions {\n"
    for f in header.functions:
        parameters = ", ".join(f"{p['name']}{'_' if p['name'] in RESERVED else ''}: {types.value(p)}" for p in f["parameters"])
        yield sentence(f["doc"], "  ")
        yield f"  {f['name']}({parameters}): {types.result(f['returns'])};\n"
    yield "}\n/** Enumerations by name: dyn.JointType.FREE_FLYER. */\nexport interface Enumerations {\n"
    yield from (f"  readonly {e['name'][3:]}: {e['name'][3:]}Values;\n" for e in header.enums)
    yield "}\n"


def main(source, classes, out):
    header = Header(Path(source).read_text(encoding="utf-8"))
    Path(out).write_text("".join(written(header)) + Path(classes).read_text(encoding="utf-8"), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
