"""dyn effects, and what dyn sim says of effects and of failures."""

import json

import numpy as np
import pytest
from command import GO2, ROBOTS, answer, pytestmark, run  # noqa: F401

import libdyn as dyn

ROBOT = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
<body name="arm"><joint name="j" axis="0 1 0" damping="1e-7" stiffness="2" armature="0.01" {joint}/><geom type="capsule" fromto="0 0 0 0.5 0 0" size=".03"/></body>
</worldbody><actuator><motor joint="j"/></actuator></mujoco>"""


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "scene.xml"
    file.write_text(ROBOT.format(joint=""))
    return str(file)


def test_each_effect_is_measured(scene):
    said = answer("effects", scene, "--duration", "0.5", "--ctrl", "0.3", "--suggest", "1e-4")
    by_name = {e["name"]: e for e in said["effects"]}
    assert [n for n, e in by_name.items() if e["active"]] == ["gravity", "armature", "damping", "springs", "actuators"]
    assert all(("magnitude" in e) == e["active"] for e in by_name.values())
    assert by_name["damping"]["magnitude"] < 1e-6 < 1e-2 < by_name["gravity"]["magnitude"]
    assert all(e["bytes"] == 0 for e in by_name.values() if not e["active"])
    suggested = said["suggested"]
    assert suggested["without"] == ["damping"] and suggested["options"] == "--without damping"
    assert suggested["error"] < 1e-4
    # what it says holds of the simulation with these options
    ends = [answer("sim", scene, "--duration", "0.5", "--ctrl", "0.3", "--no-error-estimate", *more)["q"]
            for more in ((), suggested["options"].split())]
    assert 0 < np.abs(np.subtract(*ends)).max() <= suggested["error"] * (1 + 1e-9)


def test_magnitudes_are_the_largest_over_all_steps(tmp_path):
    """A damped pendulum beside an undamped one: they are farthest apart between the ends."""
    robots = []
    for name, damping in (("damped", 0.02), ("free", 0)):
        robots.append(tmp_path / f"{name}.urdf")
        robots[-1].write_text(
            '<robot name="p"><link name="a"/><link name="b"><inertial><origin xyz="0 0 -1"/><mass value="1"/><inertia ixx=".01" '
            'iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous"><parent link="a"/>'
            f'<child link="b"/><axis xyz="1 0 0"/><dynamics damping="{damping}"/></joint></robot>')
    found = answer("effects", robots[0], "--fixed", "--duration", "4.0", "--dt", "0.01", "--q", "1")["effects"]
    a, b = data = [dyn.load(robot, base="fixed").data() for robot in robots]
    most = 0.0
    for d in data:
        d.set_state(d.model.integrate(d.model.neutral(), [1.0]))
    for _ in range(400):
        a.step(0.01), b.step(0.01)
        last = abs(a.model.difference(a.q, b.q)[0])
        most = max(most, last)
    magnitude = next(e["magnitude"] for e in found if e["name"] == "damping")
    assert magnitude == pytest.approx(most, rel=1e-9) and most > 1.1 * last


def test_nothing_to_leave_out(scene):
    said = answer("effects", scene, "--duration", "0.1", "--ctrl", "1", "--suggest", "1e-15")
    assert said["suggested"]["without"] == [] and said["suggested"]["error"] == 0
    assert "nothing can be left out" in run("effects", scene, "--duration", "0.1", "--ctrl", "1", "--suggest", "1e-15")


def test_sim_profile(scene):
    said = answer("sim", scene, "--duration", "0.1", "--profile")
    assert {"gravity", "springs"} <= {e["name"] for e in said["profile"]["effects"] if "magnitude" in e}
    assert "magnitude" in run("sim", scene, "--duration", "0.1", "--profile")


def test_without(scene):
    q = {w: answer("sim", scene, "--duration", "0.2", "--without", w, "--no-error-estimate")["q"][0]
         for w in ("gravity", "springs", "contact")}
    assert q["gravity"] == 0 and abs(q["springs"]) > abs(q["contact"]) > 0.01
    go2 = {e["name"]: e["active"] for e in answer("sim", GO2, "--floating", "--duration", "0.01", "--without",
                                                  "contact,limits")["effects"]}
    assert not go2["contact"] and not go2["limits"] and go2["gravity"]


@pytest.mark.parametrize("words, message", [
    (("--suggest", "0"), "--suggest"), (("--suggest", "nan"), "--suggest"), (("--duration", "-1"), "--duration"),
    (("--dt", "0"), "--dt"), (("--without", "wind"), "wind"), (("--effects", "wind"), "wind"),
    (("--ctrl", "1,2"), "--ctrl has 2"), (("--ctrl", "x"), "--ctrl"), (("--integrator", "leapfrog"), "leapfrog"),
    (("--configuration", "standing"), "standing"), (("--q", "0", "--configuration", "qpos0"), "keep one"),
])  # fmt: skip
def test_bad_usage(scene, words, message):
    for status in (2, 1):
        try:
            said = run("effects", scene, *words, status=status)
        except AssertionError:
            continue
        assert message in said
        return
    raise AssertionError("not refused")


def test_postmortem(tmp_path):
    file, box = tmp_path / "stiff.xml", tmp_path / "box.json"
    file.write_text(ROBOT.format(joint="").replace('stiffness="2"', 'stiffness="1e12"'))
    said = run("sim", file, "--duration", "1", "--dt", "1e-2", "--integrator", "rk4", "--q", "0.1", "--postmortem", box, status=1)
    assert "step " in said
    kept = json.loads(box.read_text())
    assert kept["error"] in said and "unstable in explicit steps" in said and kept["grew"][0]["joint"] == "j"
    # the last state fails again, and the one before it can be simulated by what does not
    state = tmp_path / "state.json"
    last = kept["states"][-1]
    state.write_text(json.dumps({k: last[k] for k in ("q", "v", "tau", "ctrl")}))
    run("sim", file, "--duration", "0.02", "--dt", "1e-2", "--integrator", "rk4", "--state", state, "--no-error-estimate",
        status=1)
    run("sim", file, "--duration", "0.02", "--dt", "1e-2", "--integrator", "implicit_fast", "--q", "0.1", "--no-error-estimate")


def test_an_mjcf_file_starts_where_it_is_drawn(tmp_path):
    file = tmp_path / "drawn.xml"
    file.write_text("""<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="1 2 3"><freejoint/><geom size=".1"/></body></worldbody></mujoco>""")
    said = answer("sim", file, "--duration", "0.001", "--no-error-estimate")
    assert said["q"][:3] == pytest.approx([1, 2, 3], abs=1e-4)
    assert (answer("sim", file, "--duration", "0.001", "--no-error-estimate", "--configuration", "neutral")["q"][:2]
            == pytest.approx([0, 0], abs=1e-4))
