"""Finding the library, and refusing what does not fit."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import libdyn as dyn

needs_compiler = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")


def start(**environment):
    """Imports the package in a new process; answers its last line of errors."""
    folder = str(Path(dyn.__file__).parents[1])
    run = subprocess.run(
        [sys.executable, "-c", "import libdyn as dyn; print(dyn.library_path)"],
        env={**os.environ, "PYTHONPATH": folder, **environment}, capture_output=True, text=True,
    )  # fmt: skip
    return run.returncode, run.stdout.strip(), (run.stderr.strip().splitlines() or [""])[-1]


def test_explicit():
    status, path, _ = start(DYN_LIBRARY=dyn.library_path)
    assert status == 0 and path == dyn.library_path


def test_folder_is_searched(tmp_path):
    target = tmp_path / "libdyn.so.1"
    target.symlink_to(Path(dyn.library_path).resolve())
    assert start(DYN_LIBRARY=str(tmp_path))[1] == str(target)


def test_missing(tmp_path):
    status, _, error = start(DYN_LIBRARY=str(tmp_path / "nothing.so"))
    assert status == 1 and "LibraryError" in error and "nothing.so" in error
    assert "holds no libdyn" in start(DYN_LIBRARY=str(tmp_path))[2]


def build(folder, code):
    (folder / "x.c").write_text(code)
    subprocess.run(["cc", "-shared", "-fPIC", "x.c", "-o", "x.so"], cwd=folder, check=True)
    return str(folder / "x.so")


@needs_compiler
def test_other_major(tmp_path):
    path = build(tmp_path, 'const char* dyn_version(void) { return "2.3.4"; }')
    status, _, error = start(DYN_LIBRARY=path)
    assert status == 1 and "2.3.4" in error and "needs libdyn 1.x" in error and path in error


@needs_compiler
def test_not_libdyn(tmp_path):
    assert "is not libdyn" in start(DYN_LIBRARY=build(tmp_path, "int x;"))[2]


@needs_compiler
def test_too_old(tmp_path):
    error = start(DYN_LIBRARY=build(tmp_path, 'const char* dyn_version(void) { return "1.0.0"; }'))[2]
    assert "has no function" in error and "update libdyn" in error


@pytest.mark.parametrize(("call", "name"), [
    (lambda m, n: m.data().set_step_options(max_iterations=n), "max_iterations"),
    (lambda m, n: dyn.load_string("<mujoco/>", constraint_slots=n), "constraint_slots"),
    (lambda m, n: dyn.load_string("<mujoco/>", contact_capacity=n), "contact_capacity"),
    (lambda m, n: dyn.Builder("x").set_contact_capacity(n), "contacts"),
    (lambda m, n: dyn.Builder("x").set_constraint_slots(n), "slots"),
    (lambda m, n: dyn.batch.rollout(m, steps=n), "steps"),
    (lambda m, n: dyn.batch.rollout(m, steps=n, every=n), "every"),
    (lambda m, n: dyn.batch.rollout(m, steps=2, n=n), "n"),
])  # fmt: skip
@pytest.mark.parametrize("number", [2**32 + 1, 2**31, 10**30, 2.5])
def test_integers_are_not_cut(call, name, number):
    b = dyn.Builder("one")
    b.add_joint("j", "revolute", None).add_body("b", "j", 1.0, (0.1, 0, 0))
    with pytest.raises(dyn.Error, match=rf"{name} is"):
        call(b.finish(), number)
