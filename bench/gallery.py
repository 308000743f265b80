"""Pictures of the examples for the site's gallery (tools/site): the robot or scene that each is about.

    python3 bench/gallery.py          # writes capi/pages/gallery/NAME.png
"""

import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "capi" / "python" / "examples"))
import four_bar  # noqa: E402
import grasp  # noqa: E402
import thrown_box  # noqa: E402
import two_muscles  # noqa: E402

OUT = ROOT / "capi/pages/gallery"
ROBOTS, SCENES = ROOT / "models/robots", ROOT / "models/scenes"
SIZE = 320, 240


def arm(seed=None):
    model = dyn.load(ROBOTS / "panda.urdf", base="fixed")
    if seed is None:
        bent = {f"panda_joint{k}": x for k, x in zip(range(1, 8), (0, -0.5, 0, -2.2, 0, 1.8, 0.8))}
        q = model.neutral()
        for name, x in bent.items():
            q[model.joint(name).idx_q] = x
        return model, q
    return model, model.random(seed)


def pendulum(*q):
    return dyn.load(ROBOTS / "double_pendulum.urdf", base="fixed"), np.array(q)


def quadruped(push=0.0):
    """Standing, or after a sideward push of so many newtons for 0.2 s."""
    sim = dyn.Simulation(dyn.load(SCENES / "go2_stands.xml"), "standing", dt=2e-3)
    if push:
        sim.data.apply_wrench("base", [0, push, 0, 0, 0, 0])
        sim.run(0.2)
    return sim.data.model, np.array(sim.data.q)


def linkage():
    model = dyn.load(four_bar.FOUR_BAR, base="fixed")
    return model, model.data().project(four_bar.closed_form(1.0)).q


def held():
    model = grasp.scene()
    return model, grasp.closed(model, grasp.data_of(model))


def thrown():
    sim = dyn.Simulation(dyn.load_string(thrown_box.SCENE), v=[2, 0, 1, 0, 3, 0])
    sim.run(0.25)
    return sim.data.model, np.array(sim.data.q)


def muscles():
    b = dyn.Builder.from_model(two_muscles.arm())
    b.add_shape("forearm", "capsule", (0.02, 0.26), placement=dyn.Placement([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], [0.15, 0, 0]))
    return b.finish(), np.array([-0.4])


EXAMPLES = {
    "accuracy_study.py": lambda: pendulum(1.2, 0.4),
    "derivatives.py": quadruped,
    "effects_study.py": lambda: arm(2),
    "four_bar.py": linkage,
    "grasp.py": held,
    "gravity_compensation.py": lambda: arm(5),
    "identification.py": lambda: arm(3),
    "inverse_kinematics.py": arm,
    "learn.py": lambda: quadruped(60),
    "operational_space.py": arm,
    "pushes.py": lambda: quadruped(150),
    "quadruped_project.py": quadruped,
    "quadruped_stands.py": lambda: quadruped(60),
    "self_collision.py": lambda: arm(11),
    "standing.py": quadruped,
    "swing_up.py": lambda: pendulum(3.1, 0.2),
    "thrown_box.py": thrown,
    "two_muscles.py": muscles,
    "feet.c": quadruped,
    "realtime.c": lambda: arm(7),
    "rnea.c": lambda: pendulum(0.6, 0.9),
    "quadruped.cpp": quadruped,
    "whole_body.cpp": lambda: quadruped(100),
}


def main():
    OUT.mkdir(exist_ok=True)
    for name, make in EXAMPLES.items():
        model, q = make()
        dyn.write_png(dyn.Renderer(model, *SIZE).render(q), OUT / f"{name}.png")
        print(name, (OUT / f"{name}.png").stat().st_size)


if __name__ == "__main__":
    main()
