"""Model.save, Model.to_bytes and dyn convert."""

import json
import os
import subprocess

import numpy as np
import pytest

import libdyn as dyn

MODELS = os.environ.get("DYN_MODELS_DIR", os.path.join(os.path.dirname(__file__), "..", "..", "..", "models"))


@pytest.fixture(scope="module")
def go2():
    return dyn.load(os.path.join(MODELS, "robots", "go2.urdf"), "floating")


@pytest.mark.parametrize("name", ["m.urdf", "m.xml", "m.dynb"])
def test_a_model_comes_back(go2, tmp_path, name):
    lines = go2.save(tmp_path / name)
    back = dyn.load(tmp_path / name, "floating" if name == "m.urdf" else None)
    assert (back.nq, back.nv) == (go2.nq, go2.nv)
    q = go2.random(1)
    M, again = np.array(dyn.Data(go2).crba(q)), np.array(dyn.Data(back).crba(q))
    np.testing.assert_allclose(again, M, rtol=0, atol=1e-12 * abs(M).max())
    assert all(isinstance(line.level, dyn.ReportLevel) and line.message for line in lines)
    assert (name == "m.xml") == any("velocity limits" in line.message for line in lines if line.level == dyn.ReportLevel.DROPPED)


def test_what_is_refused(go2, tmp_path):
    with pytest.raises(dyn.ArgumentError, match="extension"):
        go2.save(tmp_path / "m.sdf")
    with pytest.raises(dyn.ArgumentError, match="zero"):
        go2.save("m\0.urdf")
    with pytest.raises(dyn.FileError):
        go2.save(tmp_path / "nowhere" / "m.urdf")
    with pytest.raises(dyn.StrictError, match="velocity limits"):
        go2.save(tmp_path / "m.xml", strict=True)
    assert list(tmp_path.iterdir()) == []


def test_bytes_are_what_a_file_has(go2, tmp_path):
    go2.save(tmp_path / "m.dynb")
    assert go2.to_bytes("dynb") == (tmp_path / "m.dynb").read_bytes()
    assert go2.to_bytes(dyn.Format.URDF).startswith(b"<robot")
    with pytest.raises(dyn.ArgumentError, match="format"):
        go2.to_bytes("sdf")


@pytest.mark.skipif("DYN_CLI" not in os.environ, reason="needs the command")
def test_the_command_converts(tmp_path):
    def convert(*arguments):
        return subprocess.run([os.environ["DYN_CLI"], "convert", *map(str, arguments)], capture_output=True, text=True)

    go2, out = os.path.join(MODELS, "robots", "go2.urdf"), tmp_path / "go2.xml"
    done = convert(go2, out, "--floating")
    assert done.returncode == 0 and done.stdout == "" and "warning: lost: velocity limits" in done.stderr
    assert dyn.load(out).nq == 19
    strict = convert(go2, tmp_path / "strict.xml", "--floating", "--strict")
    assert strict.returncode == 1 and not (tmp_path / "strict.xml").exists()
    said = json.loads(convert(go2, tmp_path / "go2.dynb", "--floating", "--json").stdout)
    assert said["report"] == [] and dyn.load(said["file"]).nq == 19
    assert convert(go2).returncode == 2
    unknown = convert(go2, tmp_path / "go2.sdf", "--floating")
    assert unknown.returncode == 2 and all(x in unknown.stderr for x in ("go2.sdf", ".urdf", ".xml", ".mjcf", ".dynb", ".c "))
