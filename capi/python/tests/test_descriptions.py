"""Robots of other packages by name."""

import shutil
import sys

import pytest
from conftest import MODELS

import libdyn as dyn


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """robot_descriptions and example-robot-data with robots of ours."""
    repository, robots = tmp_path / "repository", tmp_path / "robot_descriptions"
    (repository / "go2/urdf").mkdir(parents=True), robots.mkdir()
    shutil.copy(MODELS / "robots/go2.urdf", repository / "go2/urdf/go2.urdf")
    shutil.copy(MODELS / "scenes/go2_stands.xml", repository / "go2/go2.xml")
    (robots / "__init__.py").touch()
    begin = f"REPOSITORY_PATH = {str(repository)!r}\nPACKAGE_PATH = REPOSITORY_PATH + '/go2'\n"
    (robots / "go2_description.py").write_text(begin + "URDF_PATH = PACKAGE_PATH + '/urdf/go2.urdf'\n")
    (robots / "go2_mj_description.py").write_text(begin + "MJCF_PATH = PACKAGE_PATH + '/go2.xml'\n")
    share = tmp_path / "cmeel.prefix/share/example-robot-data/robots/panda_description/urdf"
    share.mkdir(parents=True)
    shutil.copy(MODELS / "robots/panda.urdf", share / "panda.urdf")
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in [n for n in sys.modules if n.startswith("robot_descriptions")]:
        monkeypatch.delitem(sys.modules, name)
    yield
    for name in [n for n in sys.modules if n.startswith("robot_descriptions")]:
        del sys.modules[name]


def test_robots_by_name(packages):
    assert dyn.load_description("go2_description", base="floating").nv == 18
    assert dyn.load_description("go2_mj_description").nu == 12
    assert dyn.load_description("panda", "fixed").total_mass == dyn.load(MODELS / "robots/panda.urdf", "fixed").total_mass
    with pytest.raises(dyn.UnknownNameError, match="did you mean 'go2_description'"):
        dyn.load_description("go2_descripton")
    with pytest.raises(dyn.BaseChoiceError):
        dyn.load_description("panda")


def test_meshes_of_example_robot_data():
    pytest.importorskip("example_robot_data", reason="package example-robot-data is not installed")
    model = dyn.load_description("panda", "fixed")
    assert model.nv > 0 and not [r for r in model.report if "cannot be read" in r.message]


def test_without_packages(monkeypatch, tmp_path):
    monkeypatch.setattr("libdyn.descriptions._shares", lambda: [])
    monkeypatch.setattr("libdyn.descriptions._names_of_robot_descriptions", lambda: [])
    with pytest.raises(dyn.FileError, match="pip install robot_descriptions"):
        dyn.load_description("go2_description")
