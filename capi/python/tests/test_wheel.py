"""The wheel: built from the checkout, it holds one library with its variants, stubs and robots; what it unpacks to works by itself."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from conftest import CAPI

import libdyn as dyn

NEEDED = ("setuptools", "wheel", "pip")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    missing = [name for name in NEEDED if not importlib.util.find_spec(name)]
    if missing:
        pytest.skip(f"{', '.join(missing)} not installed")
    if not (CAPI / "python/setup.py").is_file():
        pytest.skip("not a checkout")
    work = tmp_path_factory.mktemp("wheel")
    checkout = work / "checkout"  # of what the build reads, so that nothing is written beside the sources
    shutil.copytree(CAPI / "python", checkout / "capi/python", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    shutil.copytree(CAPI.parent / "models/robots", checkout / "models/robots")
    library = Path(dyn.library_path).resolve().parent
    prefix = library.parents[1] if library.parent.name == "glibc-hwcaps" else library
    installed = work / "prefix/lib"  # a tree with this library and its variants alone
    for file in [*prefix.glob("libdyn.so.1"), *prefix.glob("libdyn_mesh.so"), *prefix.glob("glibc-hwcaps/*/libdyn.so.1")]:
        copy = installed / file.relative_to(prefix)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, copy)
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(work), str(checkout / "capi/python")]
    subprocess.run(command, check=True, env={**os.environ, "DYN_PREFIX": str(work / "prefix")}, cwd=work)
    (found,) = work.glob("*.whl")
    return found, installed


def test_what_it_holds(wheel):
    file, installed = wheel
    with zipfile.ZipFile(file) as z:
        names = set(z.namelist())
        metadata = next(z.read(n).decode() for n in names if n.endswith("METADATA"))
    assert re.fullmatch(r"libdyn-[\d.]+-py3-none-(linux|macosx)_\w+\.whl", file.name)
    assert {n for n in names if n.startswith("libdyn/lib/")} == {f"libdyn/lib/{p.relative_to(installed)}" for p in installed.rglob("*.so*")}
    assert "libdyn/lib/libdyn.so.1" in names
    sources = {f"libdyn/{p.relative_to(CAPI / 'python/libdyn')}" for s in ("*.py", "*.pyi") for p in (CAPI / "python/libdyn").rglob(s)}
    assert sources | {"libdyn/py.typed", "libdyn/models/go2.urdf", "libdyn/models/humanoid.urdf"} <= names
    assert "Requires-Dist: numpy" in metadata and "Provides-Extra: ray" in metadata


def test_it_works_by_itself(wheel, tmp_path):
    with zipfile.ZipFile(wheel[0]) as z:
        z.extractall(tmp_path / "site")
    program = """
import pickle, libdyn as dyn
from pathlib import Path
assert Path(dyn.__file__).is_relative_to("site") or "site" in dyn.__file__
assert "site" in dyn.library_path, dyn.library_path
m = dyn.load(Path(dyn.__file__).parent / "models/go2.urdf", base="floating")
print(m.nq, m.data().rnea(m.random(1)).shape, pickle.loads(pickle.dumps(m)).nv)
"""
    environment = {k: v for k, v in os.environ.items() if k not in ("DYN_LIBRARY", "PYTHONPATH")}
    out = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env={**environment, "PYTHONPATH": str(tmp_path / "site")}, capture_output=True, text=True)
    assert out.stdout.split() == ["19", "(18,)", "18"], out.stderr


def test_without_numpy(tmp_path):
    """A clear sentence, where numpy is not."""
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError(\"No module named 'numpy'\", name='numpy')")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(CAPI / "python")])}
    out = subprocess.run([sys.executable, "-c", "import libdyn as dyn"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert out.returncode and "dyn needs numpy: pip install numpy" in out.stderr
