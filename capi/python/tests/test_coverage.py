"""bench/coverage.py: which files it takes, what it says of one, and that it finds what became worse."""

import importlib.util
from pathlib import Path

import pytest

FILE = Path(__file__).resolve().parents[3] / "bench" / "coverage.py"
PENDULUM = """<!-- a comment --><mujoco><option timestep="0.004"/><worldbody><body><joint axis="0 1 0" damping="0.1" ref="20"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/></body></worldbody></mujoco>"""
URDF = '<robot name="r"><link name="l"/></robot>'


@pytest.fixture(scope="module")
def coverage():
    spec = importlib.util.spec_from_file_location("coverage_of_files", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_models_are_taken_and_parts_are_not(coverage, tmp_path):
    for name, text in {"a.xml": PENDULUM, "b.urdf": URDF, "part.xml": "<mujocoinclude/>", "c.xml": URDF,
                       "d.txt": PENDULUM}.items():
        (tmp_path / name).write_text(text)
    assert [(kind, path.name) for kind, path in coverage.files([tmp_path], None)] == [("MJCF", "a.xml"), ("URDF", "b.urdf")]
    assert [path.name for _, path in coverage.files([tmp_path], r"b\.")] == ["b.urdf"]


def test_a_pendulum_runs_as_in_mujoco(coverage, tmp_path):
    pytest.importorskip("mujoco")
    (tmp_path / "a.xml").write_text(PENDULUM)
    row = coverage.mjcf(tmp_path / "a.xml", 0.25)
    assert row["result"] == "as the peer" and row["sizes"] == row["timestep"] == row["begins"] == "same"
    assert float(row["moves"]) < 1e-9 and float(row["forces"]) < 1e-12
    assert "as the peer | " in coverage.summary([row | {"folder": "f", "format": "MJCF"}])


SOFT = """<mujoco><default><geom solref=".2 1"/></default><worldbody><geom type="plane" size="9 9 1"/><body pos="0 0 {height}"
  euler="20 0 0"><freejoint/><geom type="box" size=".1 .2 .05"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("height, start", [(0.2, "drawn"), (0.06, "drawn, raised")])
def test_soft_contacts_are_compared_where_they_are_rigid(coverage, tmp_path, height, start):
    pytest.importorskip("mujoco")
    (tmp_path / "a.xml").write_text(SOFT.format(height=height))
    row = coverage.mjcf(tmp_path / "a.xml", 0.5)
    assert row["result"] == "as the rigid peer" and row["start"] == start
    assert float(row["moves"]) > 0.1 and float(row["rigid"]) < float(row["moves"]) / 5


def test_what_differs_beside_rigid_contacts_is_no_rigid_peer(coverage):
    row = {}
    assert coverage.as_rigid({"start": "drawn", "rigid": 0.1, "until": 0.2}, row) is None
    assert row == {"start": "drawn", "rigid": "0.1", "until": "0.2"}
    assert coverage.as_rigid({"start": "home", "rigid": 0.01}, {}) == coverage.RIGID and coverage.as_rigid({}, {}) is None


def test_a_file_that_becomes_worse_is_found(coverage, tmp_path):
    known = tmp_path / "known.csv"
    known.write_text("folder,file,result\nf,a.xml,as the peer\nf,b.xml,differs\nf,gone.xml,as the peer\n")
    rows = [{"folder": "f", "file": "a.xml", "result": "as the peer, with warnings"},
            {"folder": "f", "file": "b.xml", "result": "fails"}]
    assert coverage.worse(rows, known) == []
    rows[0]["result"] = "differs"
    assert coverage.worse(rows, known) == ["f/a.xml: as the peer, now differs"]
