"""What `dyn effects --suggest` proposes on twenty random scenes, beside all sets of effects that could be left out."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from command import answer, pytestmark  # noqa: F401

import libdyn as dyn

STEPS, DT = 100, 0.002


def scene(random):
    """Links with damping, dry friction, springs, armature and motors, of very different sizes."""
    text, end, n = "", "", int(random.integers(2, 5))
    motors = ""
    for k in range(n):
        size = {name: 10 ** random.uniform(-7, 0) for name in ("damping", "frictionloss", "armature", "stiffness")}
        some = " ".join(f'{name}="{x:.6g}"' for name, x in size.items() if random.random() < 0.7)
        axis = " ".join(f"{x:.6g}" for x in random.normal(size=3))
        text += (f'<body pos="0 0 {-0.3 if k else 0}"><joint name="j{k}" axis="{axis}" {some}/>'
                 f'<geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03" contype="0" conaffinity="0"/>')
        end += "</body>"
        motors += f'<motor name="m{k}" joint="j{k}" gear="{10 ** random.uniform(-6, 0):.6g}"/>'
    gravity = -9.81 * (10 ** random.uniform(-7, 0) if random.random() < 0.5 else 1)
    q = random.uniform(-1, 1, n)
    return (f'<mujoco><option gravity="0 0 {gravity:.6g}" timestep="{DT}"/><worldbody>{text}{end}</worldbody><actuator>{motors}</actuator>'
            f"</mujoco>"), q, random.uniform(-1, 1, n)


def path(model, q, ctrl, effects, gravity):
    d = model.data()
    d.set_effects(effects)
    if not gravity:
        d.set_gravity([0, 0, 0])
    d.set_state(q, np.zeros(model.nv))
    d.set_control(ctrl)
    d.set_step_options(dt=DT)
    out = []
    for _ in range(STEPS):
        d.step()
        out.append(d.q.copy())
    return np.array(out)


@pytest.mark.parametrize("seed", range(20))
def test_the_suggestion_is_the_largest_set(seed, tmp_path):
    random = np.random.default_rng(seed)
    text, q, ctrl = scene(random)
    allowed = 10 ** random.uniform(-5, -2)
    file = tmp_path / "scene.xml"
    file.write_text(text)
    said = answer("effects", file, "--q", ",".join(map(str, q)), "--ctrl", ",".join(map(str, ctrl)), "--duration", STEPS * DT, "--dt",
                  DT, "--integrator", "semi_implicit_euler", "--suggest", allowed)
    active = [e["name"] for e in said["effects"] if e["active"]]
    model = dyn.load(file)
    whole = path(model, q, ctrl, [e for e in active if e != "gravity"], "gravity" in active)

    def error(without):
        kept = [e for e in active if e not in without]
        return np.abs(path(model, q, ctrl, [e for e in kept if e != "gravity"], "gravity" in kept) - whole).max()

    suggested = said["suggested"]["without"]
    assert error(suggested) < allowed
    assert error(suggested) == pytest.approx(said["suggested"]["error"], rel=1e-6, abs=1e-12)
    for larger in combinations(active, len(suggested) + 1):
        assert error(larger) >= allowed, larger
