"""The wheel: built from the checkout, it holds library, command, header, stubs and robots; what it installs works by itself."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from conftest import CAPI, MODELS

import libdyn as dyn
from libdyn import stubs

WRITTEN = [p for kind in ("py", "c", "cpp") for p in (CAPI / "python").glob(f"libdyn/**/*.{kind}")]


def test_what_it_holds(wheel):
    file, installed = wheel
    with zipfile.ZipFile(file) as z:
        names = set(z.namelist())
        metadata = next(z.read(n).decode() for n in names if n.endswith("METADATA"))
    assert re.fullmatch(rf"libdyn-{re.escape(dyn.__version__)}-py3-none-(linux|macosx)_\w+\.whl", file.name)
    assert ({n for n in names if n.startswith("libdyn/lib/lib")}
            == {f"libdyn/lib/{p.relative_to(installed)}" for p in installed.rglob("*.so*")} | {"libdyn/lib/libdyn.so"})
    assert "libdyn/lib/libdyn.so.1" in names
    sources = {p.relative_to(CAPI / "python").as_posix() for p in WRITTEN} | {f"libdyn/{name}.pyi" for name in stubs.STUBS}
    robots = {f"libdyn/share/dyn/models/{p.relative_to(MODELS)}" for p in MODELS.rglob("*") if p.suffix in (".urdf", ".xml")}
    assert sources | robots | {"libdyn/py.typed", "libdyn/include/dyn.h", "libdyn/include/dyn.hpp"} <= names
    assert any(n.endswith(".dist-info/licenses/LICENSE") for n in names)
    assert "Requires-Dist: numpy" in metadata and "Provides-Extra: ray" in metadata


@pytest.fixture(scope="module")
def site(wheel, tmp_path_factory):
    """The wheel, installed into a folder; runs a program there, without this checkout."""
    folder = tmp_path_factory.mktemp("installed")
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", str(folder / "site"), str(wheel[0])]
    subprocess.run(command, check=True)
    environment = {k: v for k, v in os.environ.items() if k not in ("DYN_LIBRARY", "DYN_CLI", "PYTHONPATH")}

    def run(*words):
        there = {**environment, "PYTHONPATH": str(folder / "site")}
        return subprocess.run(words, cwd=folder, env=there, capture_output=True, text=True)

    return run


def test_it_works_by_itself(site):
    program = """
import pickle, libdyn as dyn
from pathlib import Path
assert Path(dyn.__file__).is_relative_to("site") or "site" in dyn.__file__
assert "site" in dyn.library_path, dyn.library_path
assert Path(dyn.models).is_relative_to(Path(dyn.__file__).parent)
m = dyn.load(dyn.models / "robots/go2.urdf", base="floating")
print(m.nq, m.data().rnea(m.random(1)).shape, pickle.loads(pickle.dumps(m)).nv)
"""
    out = site(sys.executable, "-c", program)
    assert out.stdout.split() == ["19", "(18,)", "18"], out.stderr


PROGRAM = """
#include <dyn.h>
#include <stdio.h>
int main(int n, char** words) {
  dynLoadOptions options;
  dynModel* model;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  if (n != 2 || dyn_model_load(words[1], &options, &model) != DYN_OK) return 1;
  printf("nv %d\\n", dyn_model_nv(model));
  dyn_model_free(model);
  return 0;
}
"""


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_a_c_program(site, tmp_path):
    """Compiled with what `python -m libdyn` says, it runs from anywhere."""
    ask = lambda *words: site(sys.executable, "-m", "libdyn", *words).stdout.split()
    (tmp_path / "x.c").write_text(PROGRAM)
    subprocess.run(["cc", "x.c", "-o", "x", *ask("--cflags", "--libs")], cwd=tmp_path, check=True)
    out = site(tmp_path / "x", f"{ask('--models')[0]}/robots/go2.urdf")
    assert out.stdout == "nv 18\n", out.stderr
    wrong = site(sys.executable, "-m", "libdyn", "--cflags", "--lbs")
    assert wrong.returncode and "--lbs is none of --cflags, --libs" in wrong.stderr


def test_the_command(site, wheel):
    """As a script of the wheel, and through `python -m libdyn`; sweeps of accuracy run it."""
    if not (wheel[1].parent / "bin/dyn").exists():
        pytest.skip("the command dyn is not built")
    script = Path(site(sys.executable, "-c", "import libdyn; print(libdyn.__file__)").stdout.strip()).parents[1] / "bin/dyn"
    for words in ([sys.executable, str(script)], [sys.executable, "-m", "libdyn"]):
        assert site(*words, "--version").stdout.startswith("dyn 1."), words
    sweep = """
import libdyn as dyn
robot = dyn.models / "robots/double_pendulum.urdf"
print(len(dyn.accuracy.sweep(robot, base="fixed", q=[1.2, 0.4], duration=0.1, budget="2s")["points"]) > 3)
"""
    out = site(sys.executable, "-c", sweep)
    assert out.stdout == "True\n", out.stderr


def test_source_distribution(tmp_path):
    """Every file that Git knows, and what pip needs at its top."""
    if not (CAPI.parent / ".git").exists():
        pytest.skip("not a checkout")
    program = "import sys, libdyn_build as b; print(b.build_sdist(sys.argv[1]))"
    out = subprocess.run([sys.executable, "-B", "-c", program, str(tmp_path)], capture_output=True, text=True,
                         env={**os.environ, "PYTHONPATH": str(CAPI / "python/build_backend")}, check=True)
    with tarfile.open(tmp_path / out.stdout.strip()) as archive:
        names = {n.partition("/")[2] for n in archive.getnames()}
        project = archive.extractfile(f"{archive.getnames()[0].partition('/')[0]}/pyproject.toml").read().decode()
    assert {"PKG-INFO", "CMakeLists.txt", "src/model/builder.cpp", "capi/dynamics.cpp", "include/dyn.h"} <= names
    assert {p.relative_to(CAPI.parent).as_posix() for p in WRITTEN} <= names
    assert 'backend-path = ["capi/python/build_backend"]' in project and 'readme = "capi/python/README.md"' in project


def test_without_numpy(tmp_path):
    """A clear sentence, where numpy is not."""
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError(\"No module named 'numpy'\", name='numpy')")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(CAPI / "python")])}
    out = subprocess.run([sys.executable, "-c", "import libdyn as dyn"], cwd=tmp_path, env=environment, capture_output=True,
                         text=True)
    assert out.returncode and "libdyn needs numpy: pip install numpy" in out.stderr
