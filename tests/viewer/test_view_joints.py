"""Joints moved by hand on a page: frames are where the library says."""

import json
import os
import subprocess
import sys

import pytest
from conftest import BUILT, MODELS, ROOT, dyn


def test_view_moves_joints_by_hand(page, tmp_path):
    made = dyn("view", MODELS / "robots/gripper.urdf", "--fixed", "--html", tmp_path / "g.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/g.html")
    assert page.complaints == []
    info = json.loads(dyn("info", MODELS / "robots/gripper.urdf", "--fixed", "--json").stdout)
    state = {}
    for slider in page.page.locator(".joint input").all():
        low, high = float(slider.get_attribute("min")), float(slider.get_attribute("max"))
        state[slider.get_attribute("data-joint")] = x = low + 0.7 * (high - low)
        slider.fill(str(x))
    assert len(state) == info["nv"]
    (tmp_path / "s.json").write_text(json.dumps({"q": state}))
    placements = json.loads(dyn("eval", MODELS / "robots/gripper.urdf", "--fixed", "--compute", "placements,com", "--state",
                                tmp_path / "s.json", "--json").stdout)
    assert page("dynView.overlays.com.position.toArray()") == pytest.approx(placements["com"], abs=1e-6)
    placements = placements["placements"]
    shown = dict(zip(page("dynView.head.model.frames.map((f) => f.name)"),
                     page("dynView.robot.frames.map((f) => f.matrixWorld.elements)")))
    for name, placement in placements.items():
        if name in shown:
            assert shown[name][12:15] == pytest.approx(placement["translation"], abs=1e-6), name


def frames_follow_sliders(page, model, html, count):
    """Frames are where the library says for the q that the page shows, once each slider was moved."""
    made = dyn("view", model, "--html", html)
    assert made.returncode == 0, made.stderr
    page.open(f"file://{html}")
    sliders = page.page.locator(".joint input").all()
    assert len(sliders) == count
    for k, slider in enumerate(sliders):
        low, high = float(slider.get_attribute("min")), float(slider.get_attribute("max"))
        slider.fill(str(low + (0.55 + 0.4 * k / count) * (high - low)))
    q = page("Array.from(dynView.kinematics.q)")
    placements = json.loads(dyn("eval", model, "--compute", "placements", "--q", *q, "--json").stdout)["placements"]
    names = page("dynView.head.model.frames.map((f) => f.name)")
    elements = page("dynView.robot.frames.map((f) => f.matrixWorld.elements)")
    for name, e in zip(names[1:], elements[1:]):
        assert e[12:15] == pytest.approx(placements[name]["translation"], abs=1e-6), name
        assert ([e[4 * j + i] for i in range(3) for j in range(3)]
                == pytest.approx([x for row in placements[name]["rotation"] for x in row], abs=1e-6)), name
    assert page.complaints == []


def test_view_moves_joints_of_several_coordinates(page, tmp_path):
    """Every type of joint but composites, in one chain: frames are where the library says for the q that the page shows."""
    made = subprocess.run([sys.executable, "-c", CHAIN, tmp_path / "c.dynb"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "capi/python"),
                               "DYN_LIBRARY": str(BUILT.parents[1] / "lib")})
    assert made.returncode == 0, made.stderr
    frames_follow_sliders(page, tmp_path / "c.dynb", tmp_path / "c.html", int(made.stdout))


def test_view_moves_composite_joints(page, tmp_path):
    """Chains in one joint, also of joints of several coordinates and behind fixed parts, one below another and beside a
    follower."""
    made = subprocess.run([sys.executable, "-c", COMPOSITES, tmp_path / "c.dynb"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "capi/python"),
                               "DYN_LIBRARY": str(BUILT.parents[1] / "lib")})
    assert made.returncode == 0, made.stderr
    frames_follow_sliders(page, tmp_path / "c.dynb", tmp_path / "c.html", 2 + 1 + 11 + 2)


COMPOSITES = """
import sys
import libdyn as dyn
X = [0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.1, 0.2, 0.3]
Y = [1, 0, 0, 0, 0, 1, 0, -1, 0, 0.3, -0.1, 0.2]
inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
hinge = dict(type="revolute", axis=(0.6, 0, 0.8), placement=X)
b = dyn.Builder("composites")
b.add_joint("simple", "composite", placement=Y, parts=[hinge, dict(type="prismatic", axis=(0, 1, 0), placement=Y)])
b.add_joint("lead", "revolute", parent="simple", placement=X, axis=(1, 0, 0), lower=[-1.5], upper=[1.5])
b.add_joint("follow", "revolute", parent="lead", placement=X, axis=(0, 1, 0), mimic="lead", mimic_ratio=0.7, mimic_offset=0.1)
parts = [dict(type="spherical", placement=X), dict(type="fixed", placement=X), dict(type="revolute_unbounded", axis=(0, 0.6, 0.8), placement=Y)]
parts += [dict(type="helical", axis=(0, 1, 0), pitch=0.2), dict(type="planar", placement=X, axis=(0, 0, -1)), dict(type="spherical", placement=Y)]
b.add_joint("many", "composite", parent="follow", placement=X, parts=parts, armature=[0.1] * 11)
b.add_joint("last", "composite", parent="many", placement=Y, parts=[dict(type="universal", axis=(0, 0, 1), axis2=(1, 0, 0), placement=X)])
for name in ("simple", "lead", "follow", "many", "last"):
    b.add_body(f"of {name}", name, 1, inertia=inertia)
b.finish().save(sys.argv[1])
"""
CHAIN = """
import sys
import libdyn as dyn
types = sorted((t.name.lower() for t in dyn.JointType if t.name not in ("FIXED", "COMPOSITE")), key="free_flyer".__ne__)
b, above = dyn.Builder("chain"), None
for k, type in enumerate(types):
    b.add_joint(f"j{k}", type, parent=above, placement=[1, 0, 0, 0, 0, 1, 0, -1, 0, 0.1, 0.2, 0.3], axis=(0.6, 0, 0.8) if k % 2 else (0, 0, -1), axis2=(0, 1, 0), pitch=0.1)
    b.add_body(f"b{k}", f"j{k}", 1, inertia=[[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    above = f"j{k}"
model = b.finish()
model.save(sys.argv[1])
print(model.nv)
"""
