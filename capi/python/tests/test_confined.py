"""Files that are not trusted make the loader read nothing outside of their own folder and package_dirs."""

import mmap
import os
import subprocess

import libdyn as dyn
import numpy as np
import pytest
from command import CLI

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PART = '<mujocoinclude><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujocoinclude>'


def urdf(mesh):
    return f"""<robot name="r"><link name="world"/><link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<collision><geometry><mesh filename="{mesh}"/></geometry></collision></link><joint name="j" type="continuous"><parent link="world"/><child link="a"/></joint></robot>"""


@pytest.fixture
def folders(tmp_path):
    for name in ("robot/meshes", "elsewhere/package"):
        (tmp_path / name).mkdir(parents=True)
    for path in ("robot/meshes/in.obj", "elsewhere/out.obj", "elsewhere/package/p.obj"):
        (tmp_path / path).write_text(TETRAHEDRON)
    for path in ("robot/part.xml", "elsewhere/part.xml"):
        (tmp_path / path).write_text(PART)
    (tmp_path / "robot/link.obj").symlink_to(tmp_path / "elsewhere/out.obj")
    (tmp_path / "robot/link.xml").symlink_to(tmp_path / "elsewhere/part.xml")
    return tmp_path


def load(folder, text, **options):
    path = folder / "robot/model.xml"
    path.write_text(text)
    return dyn.load(path, **options)


@pytest.mark.parametrize("mesh", ["../elsewhere/out.obj", "meshes/../../elsewhere/out.obj", "link.obj",
                                  "{root}/elsewhere/out.obj", "file://{root}/elsewhere/out.obj"])
def test_meshes_outside(folders, mesh):
    text = urdf(mesh.replace("{root}", str(folders)))
    try:
        load(folders, text, meshes="hull")  # nothing holds it by default
    except dyn.UnsupportedError:
        pytest.skip("no module of meshes")
    with pytest.raises(dyn.FileError, match="confined"):
        load(folders, text, meshes="hull", confined=True)
    load(folders, text, meshes="hull", confined=True, package_dirs=folders / "elsewhere")


OUTSIDE = ["../elsewhere/out.obj", "link.obj", "{root}/elsewhere/out.obj", "file://{root}/elsewhere/out.obj",
           "package://elsewhere/out.obj"]


@pytest.mark.parametrize("kind", ["collision", "visual"])
@pytest.mark.parametrize("mesh", OUTSIDE)
def test_meshes_that_the_loader_does_not_open(folders, mesh, kind):
    """Whoever draws the robot opens them, by the names that the model keeps."""
    text = urdf(mesh.replace("{root}", str(folders))).replace("collision", kind)
    load(folders, text)
    with pytest.raises(dyn.FileError, match="confined"):
        load(folders, text, confined=True)
    load(folders, text, confined=True, package_dirs=folders / "elsewhere")
    saved = folders / "robot/model.dynb"
    load(folders, text).save(saved)
    with pytest.raises(dyn.FileError, match="confined"):
        dyn.load(saved, confined=True)


def test_meshes_of_the_working_directory(folders, monkeypatch):
    """A name that the robot's folder has not would be opened there."""
    load(folders, urdf("none.obj"), confined=True)
    monkeypatch.chdir(folders / "elsewhere")
    with pytest.raises(dyn.FileError, match="confined"):
        load(folders, urdf("out.obj"), confined=True)
    load(folders, urdf("meshes/in.obj"), confined=True)


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
@pytest.mark.parametrize("words", [["view", "--html", "page"], ["view", "--live", "--no-browser"], ["info", "--meshes"],
                                   ["info", "--html", "page"], ["sim", "--duration", ".01", "--html", "page"]])
def test_the_command_opens_none(folders, words):
    path = folders / "robot/model.xml"
    path.write_text(urdf("../elsewhere/out.obj").replace("collision", "visual"))
    done = subprocess.run([CLI, words[0], path, "--confined", *words[1:]], cwd=folders, capture_output=True, text=True,
                          timeout=60)
    if "no page to fill" in done.stderr:
        pytest.skip("no template of pages")
    assert (done.returncode == 1 and "is outside the folders" in done.stderr and done.stdout == ""
            and not (folders / "page").exists())


def test_meshes_inside(folders):
    try:
        load(folders, urdf("meshes/in.obj"), meshes="hull", confined=True)
    except dyn.UnsupportedError:
        pytest.skip("no module of meshes")
    load(folders, urdf("package://package/p.obj"), meshes="hull", confined=True, package_dirs=folders / "elsewhere")


@pytest.mark.parametrize("name", ["../elsewhere/part.xml", "link.xml", "{root}/elsewhere/part.xml"])
def test_included_files(folders, name):
    text = f'<mujoco><include file="{name.replace("{root}", str(folders))}"/></mujoco>'
    assert load(folders, text).nv == 6
    with pytest.raises(dyn.FileError, match="confined"):
        load(folders, text, confined=True)
    assert load(folders, '<mujoco><include file="part.xml"/></mujoco>', confined=True).nv == 6


def test_a_model_in_a_mapped_file(tmp_path):
    model = dyn.load_string(urdf("x.obj"))
    (tmp_path / "m.dynb").write_bytes(model.image())
    with open(tmp_path / "m.dynb", "rb") as file:
        placed = dyn.Model.from_buffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    os.remove(tmp_path / "m.dynb")
    q, v, a = [0.3], [0.2], [0.1]
    assert np.array_equal(model.data().rnea(q, v, a), placed.data().rnea(q, v, a)) and placed.joint_name(1) == "j"
    assert len(model.image(narrow=True, names=False)) < len(model.image())
    data = placed.data()
    data.warm_up()
    with pytest.raises(dyn.Error):
        dyn.Model.from_buffer(bytearray(model.image())[:-8])
