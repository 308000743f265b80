"""A picture of eight examples: what each of them computes, from its own functions.

    python3 bench/examples_picture.py --png bench/examples.png          # matplotlib
"""

import argparse
import contextlib
import io
import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "capi" / "python" / "examples"))
import identification  # noqa: E402
import inverse_kinematics  # noqa: E402
import operational_space  # noqa: E402
import pushes  # noqa: E402
import self_collision  # noqa: E402
import swing_up  # noqa: E402
import thrown_box  # noqa: E402

PIXELS = 360, 270


def quiet(main):
    with contextlib.redirect_stdout(io.StringIO()):
        return main()


def rendered(model, configurations, **camera):
    """Pictures of several moments from one place."""
    renderer = dyn.Renderer(model, *PIXELS, dyn.Camera(follow=0, **camera))
    return np.array([renderer.render(q) for q in configurations])


def floats(axes):
    """Gravity compensation: how far an arm moves with and without."""
    model = dyn.load(identification.PANDA, base="fixed")
    home = model.integrate(model.neutral(), 0.3 * np.ones(model.nv))
    for held in (True, False):
        data, away = model.data(), []
        data.set_effects(())
        for pair in range(model.npairs):
            data.set_pair(pair, False)
        data.set_state(home)
        data.set_step_options("rk4", 2e-3)
        for _ in range(250):
            data.set_state(tau=data.gravity_torque(data.q) if held else np.zeros(model.nv))
            data.step()
            away.append(np.abs(model.difference(home, data.q)).max())
        axes.plot(2e-3 * np.arange(250), away, label="compensated" if held else "limp")
    axes.set(xlabel="s", ylabel="largest angle moved, rad"), axes.legend()


def meets(axes):
    """Inverse kinematics: a start, pale, and what ik finds."""
    model = dyn.load(inverse_kinematics.PANDA, base="fixed")
    data = model.data()
    data.forward_kinematics(model.random(0))
    target, start = data.frame_placement(inverse_kinematics.HAND), model.random(1)
    found = data.ik([dyn.ik.pose(inverse_kinematics.HAND, target)], start).q
    first, last = rendered(model, [start, found], target=(0, 0, 0.45), distance=1.9)
    axes.imshow(np.uint8(0.35 * first + 0.65 * last))


def circles(axes):
    """Operational space control: the hand's path."""
    recording = quiet(operational_space.main)
    data, path = recording.model.data(), []
    for q in recording.q:
        data.forward_kinematics(q)
        path.append(data.frame_placement(operational_space.HAND).translation.copy())
    path = np.array(path)
    axes.plot(path[:, 1], path[:, 2])
    axes.set(xlabel="y of the hand, m", ylabel="z, m", aspect="equal")


def swings(axes):
    """DDP: the angles of the pendulum."""
    path = quiet(swing_up.main)
    angles = np.array([q for q, _ in path])
    axes.plot(swing_up.H * np.arange(len(path)), angles, label=["shoulder", "elbow"])
    axes.set(xlabel="s", ylabel="rad"), axes.legend()


def thrown(axes):
    """A box that is thrown, every 70 ms."""
    recording = quiet(thrown_box.main)
    moments = rendered(recording.model, recording.q[:1000:70], target=(0.9, 0, 0.3), distance=2.8, azimuth=-90, elevation=12)
    axes.imshow(moments.min(axis=0))  # the box is darker than the floor


def kicked(axes):
    """Rollouts: which kicks a quadruped withstands."""
    model, random = dyn.load(pushes.SCENE), np.random.default_rng(1)
    speed, angle = random.uniform(0, pushes.FASTEST, 128), random.uniform(-np.pi, np.pi, 128)
    up = pushes.survivors(model, speed, angle)
    for stands, colour in ((True, "tab:green"), (False, "tab:red")):
        v = speed[up == stands] * np.array([np.cos(angle), np.sin(angle)])[:, up == stands]
        axes.scatter(*v, s=9, color=colour, label="stands" if stands else "falls")
    axes.set(xlabel="kick forwards, m/s", ylabel="to the left, m/s", aspect="equal"), axes.legend()


def identified(axes):
    """Identification: how well each set of parameters predicts torques of another motion."""
    figures = identification.identify()
    names = ["guess", "least squares", "consistent"]
    axes.bar(names, [figures[name]["prediction error"] for name in names], log=True)
    axes.set(ylabel="error of predicted torques")


def free(axes):
    """Self-collision: room of random configurations."""
    model = dyn.load(self_collision.PANDA, base="fixed")
    names = [[model.frame_name(model.shape(shape).frame) for shape in pair[:2]] for pair in model.pairs]
    counted = [k for k, pair in enumerate(names) if not all("finger" in name for name in pair)]
    data = model.data()
    axes.hist([1e3 * data.compute_distances(model.random(k))[counted].min() for k in range(4000)], 60)
    axes.set(xlabel="least distance of links, mm", ylabel="configurations of 4000")


EXAMPLES = {
    "gravity_compensation": floats, "inverse_kinematics": meets, "operational_space": circles, "swing_up": swings,
    "thrown_box": thrown, "pushes": kicked, "identification": identified, "self_collision": free,
}  # fmt: skip


def main(path):
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    figure, rows = plt.subplots(2, 4, figsize=(14, 6.4), layout="constrained")
    for axes, (name, draw) in zip(rows.flat, EXAMPLES.items()):
        draw(axes)
        axes.set_title(f"{name}.py", fontsize=10)
        if axes.images:
            axes.set(xticks=[], yticks=[])
    figure.savefig(path, dpi=80, metadata={"Software": None})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--png", required=True)
    main(parser.parse_args().png)
