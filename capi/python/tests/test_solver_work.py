"""What steps cost with a heavy box on a light one: sums over twenty motions, which rounding hardly moves."""

import numpy as np
import pytest

import libdyn as dyn

LIGHT, STEPS = 1.0, 60  # kg
PUSHES = np.linspace(0.01, 0.03, 20)  # m/s, rad/s


def stack(heavy, push, tolerance):
    """Two cubes of 0.1 m on the ground, one on the other, that begin to slide and to tilt."""
    b = dyn.Builder("stack")
    b.add_shape("universe", "half_space", material=dyn.Material(friction=0.5))
    for k, mass in enumerate((LIGHT, heavy)):
        b.add_joint(f"j{k}", "free_flyer").add_body(f"box{k}", f"j{k}", mass=mass, inertia=np.eye(3) * mass / 600)
        b.add_shape(f"box{k}", "box", (0.1, 0.1, 0.1), material=dyn.Material(friction=0.5))
    d = b.finish().data(dyn.Part.ALL)
    d.q = [0, 0, 0.05, 0, 0, 0, 1, 0, 0, 0.15, 0, 0, 0, 1]
    d.v = push * np.sin(1 + 3 * np.arange(12))
    d.set_step_options("semi_implicit_euler", 1e-3, tolerance=tolerance)
    return d


@pytest.mark.parametrize("tolerance", (0, 1e-9))
@pytest.mark.parametrize("heavy, most", ((1e3, 3900), (1e4, 8000)))
def test_heavy_boxes_on_light_ones_are_solved_in_few_iterations(heavy, most, tolerance):
    """Newton's method takes impulses beyond those of the guess. At rest a solve ends once the boxes stand."""
    iterations = unsolved = 0
    for push in PUSHES:
        d = stack(heavy, push, tolerance)
        for _ in range(STEPS):
            d.step()
            iterations += d.step_report.iterations
            unsolved += d.step_report.unsolved
    assert iterations < most
    assert unsolved <= 10
