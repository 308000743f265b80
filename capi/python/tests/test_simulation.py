"""Steps with contact: what a robot on the ground feels, materials, the command, and the example of a quadruped that stands."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from command import GO2, answer, run

import libdyn as dyn

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def box_on_ground(material=None, **kwargs):
    b = dyn.Builder("box").add_joint("free", "free_flyer").add_body("box", "free", 2.0, inertia=np.eye(3) * 2 / 150)
    b.add_shape("universe", "half_space", name="ground", material=dyn.Material(friction=0))
    return b.add_shape("box", "box", (0.2, 0.2, 0.2), material=material, **kwargs).finish()


def test_a_box_rests():
    m = box_on_ground(dyn.Material(friction=0.3))
    d = m.data()
    q = m.neutral()
    q[2] = 0.25
    d.set_state(q)
    d.set_step_options("semi_implicit_euler", 1e-3, solver="newton", tolerance=1e-10, max_iterations=500)
    report = d.advance(1.0)
    assert report.contacts == 4 and report.islands == 1 and report.rows == 12 and report.dropped == 0
    assert report.residual <= 1.01e-10 and report.penetration < 1e-9
    assert d.q[2] == pytest.approx(0.1, abs=1e-9)
    contacts = d.step_contacts()
    assert len(contacts) == 4 and sum(c.force_on_b[2] for c in contacts) == pytest.approx(2 * 9.81, rel=1e-8)
    assert all(c.contact.normal == pytest.approx([0, 0, 1]) and c.contact.shape_b == 1 for c in contacts)


@pytest.mark.parametrize("share", [1.02, 1.2, 3.0])
@pytest.mark.parametrize("mu", [0.5, 1.0])
@pytest.mark.parametrize("hand", [False, True])
def test_two_fingers_hold_a_box(hand, mu, share):
    """Squeezed by a little more than friction needs, it stays. That it turns about an edge of the pads, which would press there
    alone, solves Coulomb's law as well."""
    mass, size = 0.2, np.array([0.02, 0.03, 0.03])
    b = dyn.Builder("gripper")
    if hand:
        b.add_joint("lift", "prismatic", axis=[0, 0, 1]).add_body("palm", "lift", 1.0, inertia=0.01 * np.eye(3))
    for name, side in (("left", 1), ("right", -1)):
        placement = np.eye(4)
        placement[1, 3] = side * (size[1] / 2 + 0.005)
        b.add_joint(name, "prismatic", "lift" if hand else None, placement,
                    axis=[0, 1, 0]).add_body(name, name, 0.05, inertia=1e-4 * np.eye(3))
        b.add_shape(name, "box", [0.02, 0.01, 0.03], name=f"{name}_pad")
    b.add_joint("box_joint", "free_flyer").add_body("box", "box_joint", mass,
                                                    inertia=np.diag(mass / 12 * (np.sum(size**2) - size**2)))
    m = b.add_shape("box", "box", size, name="box").finish()
    data = m.data()
    data.set_shape_material(None, dyn.Material(friction=mu))
    data.set_step_options("semi_implicit_euler", 1e-3, tolerance=1e-10)
    tau, squeeze = np.zeros(m.nv), share * mass * 9.81 / (2 * mu)
    tau[m.joint("left").idx_v], tau[m.joint("right").idx_v] = -squeeze, squeeze
    if hand:
        tau[m.joint("lift").idx_v] = 1.3 * 9.81  # of palm, fingers and box
    data.set_state(m.neutral(), np.zeros(m.nv), tau=tau)
    data.advance(0.5)
    box = m.joint("box_joint").idx_q
    assert np.max(np.abs(data.q[box : box + 6])) < 1e-9


def test_materials():
    m = box_on_ground(dyn.Material(0.3, torsion=0.01, surface_velocity=(1, 2, 3)))
    assert (m.shape(1).material == dyn.Material(0.3, torsion=0.01, surface_velocity=(1, 2, 3))
            and m.shape(0).material.friction == 0)
    d = m.data()
    d.set_shape_material(1, dyn.Material(restitution=0.5))
    assert d.shape_material(1).restitution == 0.5 and d.shape_material(0).friction == 0
    with pytest.raises(dyn.ArgumentError, match="restitution"):
        d.set_shape_material(None, dyn.Material(restitution=1.5))
    with pytest.raises(dyn.InvalidRobotError, match="friction"):
        box_on_ground(dyn.Material(friction=-1))


def test_a_pair_that_is_off_does_not_touch():
    m = box_on_ground()
    d = m.data()
    d.set_pair(0, False)
    q = m.neutral()
    q[2] = 0.11
    d.set_state(q)
    d.advance(0.5)
    assert d.q[2] < -1 and d.step_contacts() == []


def test_the_command_on_the_ground():
    found = answer("sim", GO2, "--floating", "--ground", "--duration", "0.6", "--no-error-estimate")
    assert (found["contacts_max"] >= 4 and found["residual_max"] < 1e-2 and found["penetration_max"] < 1e-4
            and found["solver"] == "admm")
    assert any("starts on the ground" in w for w in found["warnings"])
    assert {e["name"] for e in found["effects"] if e["active"]} >= {"gravity", "contact", "limits"}
    assert "contact " in run("sim", GO2, "--floating", "--ground", "--duration", "0.1", "--solver", "pgs", "--no-error-estimate")
    assert "lcp" in run("sim", GO2, "--floating", "--ground", "--duration", "0.1", "--solver", "lcp", status=2)
    assert "tolerance" in run("sim", GO2, "--floating", "--ground", "--duration", "0.1", "--tolerance", "-1", status=2)


def test_a_quadruped_stands(capsys, monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    spec = importlib.util.spec_from_file_location("quadruped_stands", EXAMPLES / "quadruped_stands.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    monkeypatch.delitem(sys.modules, "standing")
    assert example.main(5.0) == 0
    text = capsys.readouterr().out
    assert text.count("pushed from the") == 4 and "never fewer than 4 contact points" in text


def test_states_are_kept():
    m = box_on_ground(dyn.Material(friction=0.3, restitution=0.4))
    d = m.data()
    q = m.neutral()
    q[2] = 0.4
    d.set_state(q, [1, 0, 0, 0, 3, 1])
    d.advance(0.3)
    kept = d.save_state()
    d.advance(0.2)
    end = d.q.copy()
    d.restore_state(kept)
    assert d.time == pytest.approx(0.3)
    d.advance(0.2)
    assert np.array_equal(d.q, end)
    with pytest.raises(dyn.SizeError, match="Data.save_state"):
        d.restore_state(kept[:-1])


def test_limits_keep_their_forces():
    """An arm that lies at its limits, one upper and one lower: the forces of the step before solve the next one."""
    m = dyn.load_string("""<mujoco><option timestep="0.002"/><worldbody>
        <body><joint axis="0 1 0" range="-60 20"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/>
          <body pos=".4 0 0"><joint axis="0 -1 0" range="-30 60"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
          </body></body></worldbody></mujoco>""")
    d = m.data()
    d.advance(1)
    assert d.q == pytest.approx(np.deg2rad([20, -30]), abs=1e-9) and abs(d.v).max() < 1e-9
    kept, first = d.save_state(), []
    for _ in range(2):
        d.restore_state(kept)
        work = 0
        for _ in range(50):
            d.step()
            work += d.step_report.iterations
        assert work == 0 and d.step_report.residual < 1e-9
        first.append((d.q.tolist(), d.v.tolist()))
    assert first[0] == first[1]
    d.reset()
    d.advance(1)
    d.reset()  # forgets the forces: the first steps are those of new data
    fresh = m.data()
    d.step(), fresh.step()
    assert np.array_equal(d.q, fresh.q) and np.array_equal(d.v, fresh.v)


def test_the_ledger():
    m = box_on_ground(dyn.Material(friction=0.4))
    d = m.data()
    q, v = m.neutral(), np.zeros(6)
    q[2], v[0] = 0.1, 1.0
    d.set_state(q, v)
    d.set_step_options("semi_implicit_euler", 1e-3, ledger=True)
    d.advance(0.5)
    x = d.ledger
    assert x.steps == 500 and x.contact_friction == pytest.approx(-1, abs=1e-8) and x.energy_change == pytest.approx(-1, abs=1e-9)
    assert abs(x.energy_defect) < 1e-8 and x.momentum_defect == pytest.approx(np.zeros(3), abs=1e-12)
    d.set_step_options(ledger=False)
    d.step()
    assert d.ledger.steps == 0
    with pytest.raises(dyn.PartError, match="dyn.Part.ENERGY"):
        m.data(dyn.Part.SIMULATION).set_step_options(ledger=True)


def test_sim_ledger():
    x = answer("sim", GO2, "--floating", "--ground", "--duration", "0.05", "--ledger", "--no-error-estimate")["ledger"]
    sources = sum(v for k, v in x.items()
                  if isinstance(v, float) and not k.startswith(("energy", "constraint_drift", "cone", "complementarity")))
    assert x["energy_change"] == pytest.approx(sources + x["energy_defect"], abs=1e-9)
    assert x["damping"] < 0 and x["friction"] < 0
    assert "energy_defect" in run("sim", GO2, "--floating", "--ground", "--duration", "0.05", "--ledger", "--no-error-estimate")


def test_steps_for_an_accuracy_while_a_robot_lies_on_the_ground():
    said = answer("sim", GO2, "--floating", "--ground", "--duration", "0.3", "--accuracy", "1e-2", "--q",
                  "0,0,0.33331,0,0,0,1" + ",0,0.8,-1.5" * 4)
    assert said["steps"] < 20000 and said["penetration_max"] < 1e-3  # a tenth of the accuracy counts as touching
    assert (said["step_errors"] > 3e-2) == any("was not reached" in w for w in said["warnings"])
    assert (said["error_estimate"] is None) == any("no digit" in w for w in said["warnings"])
