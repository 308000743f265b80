"""The package against dyn.h: every function has its place, structures are those of a C compiler, byte for byte."""

import ctypes
import re
import shutil
import subprocess

import pytest
from conftest import CAPI

import libdyn as dyn
from libdyn import abi, enums, joint_spec, library, messages, native
from libdyn.interface import FUNCTIONS

HEADER = (CAPI.parent / "include" / "dyn.h").read_text()
CODE = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S)


def test_every_function_has_its_place_in_python(go2):
    """Messages speak of it there; but for those that Python has no use for, as it frees and initialises by itself."""
    unnamed = {"dyn_last_error", "dyn_build_info", "dyn_interface_json",
               "dyn_so3_compose", "dyn_so3_inverse", "dyn_so3_act"}  # of rotations: numpy's R @ S, R.T, R @ x
    for name in FUNCTIONS:
        if name in unnamed or re.search("_(free|init)$|^dyn_enum_", name):
            continue
        owner, _, member = messages.in_python(name).rpartition(".")
        place = dyn if owner == "dyn" else go2 if owner == "Model" else getattr(dyn, owner)
        assert hasattr(place, member), f"{name}: {owner} has no {member}"


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


def test_joints_of_the_cpp_builder_have_every_array():
    wrapper = (CAPI.parent / "include" / "dyn.hpp").read_text()
    for name in joint_spec.ARRAYS:
        assert f"s.{name} = optional(spec.{name}, " in wrapper, f"JointSpec of dyn.hpp lacks {name}"


def test_functions_have_few_arguments():
    """At most six beside handles; beyond that they take a structure."""
    handles = "|".join(re.findall(r"typedef struct (dyn\w+) \1;", CODE))
    long = {}
    for name, given in re.findall(r"DYN_API[^;(]*?(dyn_\w+)\(([^;]*)\);", CODE):
        others = [x for x in given.split(",") if not re.match(rf"\s*(const )?({handles})\* *\w+$", x)]
        if len(others) > 6:
            long[name] = len(others)
    assert not long


def test_every_status_has_its_exception():
    for status in enums.Status:
        if status:
            cls = dyn.errors.BY_STATUS[status]
            assert issubclass(cls, dyn.Error) and cls.status == status
            assert library.lib.dyn_status_name(status).decode() == f"DYN_{status.name}"
    assert library.lib.dyn_status_name(12345)


def test_version():
    assert dyn.__version__.split(".")[0] == str(native.MAJOR)
    assert dyn.build_info and "\n" not in dyn.build_info


def test_pages_draw_every_primitive():
    drawn = re.findall(r'case "(\w+)":', (CAPI.parent / "tools" / "viewer" / "src" / "shapes.js").read_text())
    assert (sorted(drawn)
            == sorted(t.name.lower() for t in dyn.ShapeType if t.name not in ("MESH", "CONVEX", "TRIANGLES", "HEIGHT_FIELD",
                                                                              "HALF_SPACE")))
