"""The package against dyn.h: every function, every enumeration value, every structure, byte for byte."""

import ctypes
import re
import shutil
import subprocess

import pytest
from conftest import CAPI

import libdyn as dyn
from libdyn import abi, enums, library

HEADER = (CAPI.parent / "include" / "dyn.h").read_text()
CODE = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S)


def test_every_function_is_bound():
    declared = set(re.findall(r"DYN_API[^;(]*?\b(dyn_\w+)\s*\(", CODE))
    assert declared and declared == set(abi.SIGNATURES)


def test_every_function_is_used():
    sources = "".join(p.read_text() for p in (CAPI / "python" / "libdyn").glob("*.py"))
    assert not [name for name in abi.SIGNATURES if not re.search(rf"\b{name}\b", sources)]


def test_number_of_arguments():
    for name, arguments in re.findall(r"DYN_API[^;(]*?\b(dyn_\w+)\s*\(([^;]*)\)\s*;", CODE):
        count = 0 if arguments.strip() == "void" else arguments.count(",") + 1
        assert len(abi.SIGNATURES[name][1]) == count, name


ANONYMOUS = [(enums.Part, "DYN_PART_"), (enums.Term, "DYN_TERM_"), (enums.Effect, "DYN_EFFECT_"), (enums.Status, "DYN_(?=ERROR|OK)")]


@pytest.mark.parametrize("enum, prefix", ANONYMOUS, ids=[enum.__name__ for enum, _ in ANONYMOUS])
def test_bits_and_status(enum, prefix):
    values = {}
    for name, value in re.findall(rf"\b{prefix}([A-Z0-9_]+)\s*=\s*([^,}}\s][^,}}]*)", CODE):
        values[name] = eval(value.replace("u", ""))
    assert values == {name: int(member) for name, member in enum.__members__.items()}


# what a batch runs are methods of dyn.Batch
KINDS = [(kind, body) for kind, body in re.findall(r"typedef enum dyn(\w+) \{(.*?)\}", CODE, re.S) if kind not in ("Algorithm", "Status")]


@pytest.mark.parametrize("kind, body", KINDS, ids=[kind for kind, _ in KINDS])
def test_every_type_of_the_header(kind, body):
    prefix = "DYN" + re.sub("([A-Z])", r"_\1", kind).upper() + "_"
    values = {name: int(value) for name, value in re.findall(rf"{prefix}(\w+)\s*=\s*(-?\d+)", body)}
    assert values and values == {name: int(member) for name, member in getattr(enums, kind).__members__.items()}


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_structures(tmp_path):
    structs = {name: body for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (dyn\w+);", CODE, re.S)}
    lines, expected = [], {}
    for name in structs:
        cls = getattr(abi, name.removeprefix("dyn"))
        expected[name] = ctypes.sizeof(cls)
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, *_ in cls._fields_:
            expected[f"{name}.{field}"] = getattr(cls, field).offset
            lines.append(f'printf("{name}.{field} %zu\\n", offsetof({name}, {field}));')
    (tmp_path / "s.c").write_text('#include <stdio.h>\n#include "dyn.h"\nint main(void) {' + "\n".join(lines) + "return 0; }")
    subprocess.run(["cc", "-I", str(CAPI.parent / "include"), "s.c", "-o", "s"], cwd=tmp_path, check=True)
    printed = subprocess.run([str(tmp_path / "s")], capture_output=True, text=True, check=True).stdout
    assert {k: int(v) for k, v in (line.split() for line in printed.splitlines())} == expected


def test_every_status_has_its_exception():
    for status in enums.Status:
        if status:
            cls = dyn.errors.BY_STATUS[status]
            assert issubclass(cls, dyn.Error) and cls.status == status
            assert library.lib.dyn_status_name(status).decode() == f"DYN_{status.name}"
    assert library.lib.dyn_status_name(12345)


def test_version():
    assert dyn.__version__.split(".")[0] == str(abi.MAJOR)
    assert dyn.build_info and "\n" not in dyn.build_info


def test_pages_draw_every_primitive():
    drawn = re.findall(r'case "(\w+)":', (CAPI.parent / "tools" / "viewer" / "src" / "shapes.js").read_text())
    assert sorted(drawn) == sorted(t.name.lower() for t in dyn.ShapeType if t.name not in ("MESH", "CONVEX", "TRIANGLES", "HEIGHT_FIELD", "HALF_SPACE"))
