"""The wheel: built from the checkout, it holds one library with its variants, stubs and robots; what it unpacks to works by itself."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

from conftest import CAPI

from libdyn import stubs

def test_what_it_holds(wheel):
    file, installed = wheel
    with zipfile.ZipFile(file) as z:
        names = set(z.namelist())
        metadata = next(z.read(n).decode() for n in names if n.endswith("METADATA"))
    assert re.fullmatch(r"libdyn-[\d.]+-py3-none-(linux|macosx)_\w+\.whl", file.name)
    assert ({n for n in names if n.startswith("libdyn/lib/")}
            == {f"libdyn/lib/{p.relative_to(installed)}" for p in installed.rglob("*.so*")})
    assert "libdyn/lib/libdyn.so.1" in names
    sources = {f"libdyn/{p.name}" for p in (CAPI / "python/libdyn").glob("*.py")} | {f"libdyn/{name}.pyi" for name in stubs.STUBS}
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
    out = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env={**environment, "PYTHONPATH": str(tmp_path / "site")},
                         capture_output=True, text=True)
    assert out.stdout.split() == ["19", "(18,)", "18"], out.stderr


def test_without_numpy(tmp_path):
    """A clear sentence, where numpy is not."""
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError(\"No module named 'numpy'\", name='numpy')")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(CAPI / "python")])}
    out = subprocess.run([sys.executable, "-c", "import libdyn as dyn"], cwd=tmp_path, env=environment, capture_output=True,
                         text=True)
    assert out.returncode and "libdyn needs numpy: pip install numpy" in out.stderr
