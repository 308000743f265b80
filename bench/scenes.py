#!/usr/bin/env python3
"""Steps of scenes with contact, beside MuJoCo in one run: time of a step, and what each lets through.

    python bench/scenes.py [--seconds 1] [--dt 0.002] [--passes 3] [--humanoids FOLDER] [--linear] [--plot FILE.svg] [SCENE ...]

Needs the packages mujoco and dyn (and matplotlib for the plot). The same MJCF goes to both. MuJoCo runs with its solvers Newton
and CG, pyramidal and elliptic cones, Euler and implicitfast, otherwise as it is by default; the fastest counts, whatever its
errors. libdyn runs as it is by default (admm, residual 1e-4), with Gauss-Seidel to 1e-3 and 1e-2 in at most 50 sweeps and to 1e-1
in 10, and in two steps of half the size: `ratio` is that of the fastest of these whose errors are all at most MuJoCo's or
round-off (1e-9 of overlap, slip and energy; 1e-12 of momentum), `default` that of the first. Times are the processor's, of this
thread: the least of the passes, which alternate.

Errors, the largest of all steps, MuJoCo's at its fastest setting:
  overlap     the deepest, less that at the beginning
  slip        way of the first body across gravity, where nothing should move
  energy      by how much the sum has grown over its smallest value before, of scenes that nothing drives
  momentum    change of the sum, relative to the sum of m |v| at the beginning, where nothing acts from outside

--humanoids  MuJoCo's model/humanoid of github.com/google-deepmind/mujoco, which its package does not hold: adds its four scenes
             of humanoids
--linear     chains of up to 1,000 links alone
"""

import argparse
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np

# The release build of this checkout, of which the package takes the variant for this machine, unless DYN_LIBRARY says otherwise.
ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path.append(str(ROOT / "capi/python"))
import libdyn as dyn  # noqa: E402


def free(pos, shape, euler=(0, 0, 0)):
    at, turned = (" ".join(f"{x:.6f}" for x in v) for v in (pos, euler))
    return f'<body pos="{at}" euler="{turned}"><freejoint/><geom {shape} mass="1"/></body>'


def on_plane(bodies):
    return '<geom type="plane" size="5 5 1"/>' + "".join(bodies)


def stack(n):
    return on_plane(free((0, 0, 0.1 + 0.2 * k), 'type="box" size=".1 .1 .1"') for k in range(n))


def walls(half):
    text = "".join(f'<geom type="box" size=".05 {2 * half} 2" pos="{x} 0 1.5"/>' for x in (half, -half))
    return text + "".join(f'<geom type="box" size="{2 * half} .05 2" pos="0 {y} 1.5"/>' for y in (half, -half))


def poured(side):
    shake = np.random.default_rng(0).uniform(-0.01, 0.01, (side**3, 2))
    at = [((i - side / 2) * 0.22, (j - side / 2) * 0.22, 0.1 + 0.22 * k) for i in range(side) for j in range(side)
          for k in range(side)]
    return walls(1) + on_plane(free((x + s[0], y + s[1], z), 'type="sphere" size=".1"') for (x, y, z), s in zip(at, shake))


def capsules(nx, ny, nz):
    random = np.random.default_rng(0)
    at = [((i - nx / 2 + 0.5) * 0.3, (j - ny / 2 + 0.5) * 0.3, 0.15 + 0.3 * k) for k in range(nz) for i in range(nx)
          for j in range(ny)]
    return (walls(0.15 * max(nx, ny) + 0.1)
            + on_plane(free(p, 'type="capsule" size=".04 .08"', random.uniform(0, 360, 3)) for p in at))


def cloud(side):
    at = [np.array((i, j, k)) - (side - 1) / 2 for i in range(side) for j in range(side) for k in range(side)]
    return "".join(free(0.25 * p, 'type="sphere" size=".1"') for p in at)


def chain(n):
    """A model: files may not nest so deep."""
    spec = mujoco.MjSpec()
    link, spec.memory = spec.worldbody, 1 << 30
    for k in range(n):
        turn = {} if k else {"quat": (np.cos(np.pi / 6), 0, np.sin(np.pi / 6), 0)}
        link = link.add_body(pos=(0, 0, -0.1 if k else 0), **turn)
        link.add_joint(axis=(0, 1, 0))
        link.add_geom(type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=(0, 0, 0, 0, 0, -0.1), size=(0.02, 0, 0), contype=0,
                      conaffinity=0)
    return spec


# World, gravity, and what is known of it: at rest; alone, its bodies flying at one another
DOWN = (0, 0, -9.81)
SLOPE = (9.81 * np.sin(0.7), 0, -9.81 * np.cos(0.7))  # friction 1 holds up to pi/4
SCENES = {
    "box": (stack(1), DOWN, "rests"),
    "box on a slope": (stack(1), SLOPE, "rests"),
    "stack of 10 boxes": (stack(10), DOWN, "rests"),
    "27 spheres in space": (cloud(3), (0, 0, 0), "alone"),
    "27 spheres poured": (poured(3), DOWN, ""),
    "216 spheres poured": (poured(6), DOWN, ""),
    "990 capsules poured": (capsules(9, 10, 11), DOWN, ""),
    **{f"chain of {n} links": (n, DOWN, "chain") for n in (20, 200)},
}
LINEAR = {f"chain of {n} links": (n, DOWN, "chain") for n in (10, 30, 100, 300, 1000)}
HUMANOIDS = {"humanoid": "humanoid.xml", "humanoid100": "humanoid100.xml", "22 humanoids": "22_humanoids.xml",
             "100 humanoids": "100_humanoids.xml"}


def scene_text(world, dt, gravity=DOWN):
    option = f'<option timestep="{dt}" gravity="{gravity[0]} {gravity[1]} {gravity[2]}"><flag energy="enable"/></option>'
    return f'<mujoco>{option}<size memory="1G"/><worldbody>{world}</worldbody></mujoco>'


def humanoid_text(path, dt):
    """The file with what it attaches; free joints, which MuJoCo writes as others with limits, as they were."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.option.timestep, spec.memory = dt, 1 << 30
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    spec.compile()
    return re.sub(r'<joint (name="[^"]*") type="free"[^>]*/>', r"<freejoint \1/>", spec.to_xml())


def growth(energies):
    """By how much energy exceeds its smallest value so far."""
    energies = np.array(energies)
    return float(np.max(energies - np.minimum.accumulate(energies)))


SOLVERS = {"Newton": mujoco.mjtSolver.mjSOL_NEWTON, "CG": mujoco.mjtSolver.mjSOL_CG}
CONES = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}
INTEGRATORS = {"Euler": mujoco.mjtIntegrator.mjINT_EULER, "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST}


class Mujoco:
    def __init__(self, model, steps, kind):
        self.model, self.steps, self.kind = model, steps, kind
        self.best = {}  # seconds of a step by setting

    def fresh(self, setting):
        o = self.model.opt
        o.solver, o.cone, o.integrator = SOLVERS[setting[0]], CONES[setting[1]], INTEGRATORS[setting[2]]
        data = mujoco.MjData(self.model)
        if self.kind == "alone":
            data.qvel = np.hstack([np.append(-2 * q[:3], (0, 0, 0)) for q in data.qpos.reshape(-1, 7)])
        mujoco.mj_forward(self.model, data)
        return data

    def time(self):
        for setting in ((s, c, i) for s in SOLVERS for c in CONES for i in INTEGRATORS):
            data = self.fresh(setting)
            began = time.thread_time()
            for _ in range(self.steps):
                mujoco.mj_step(self.model, data)
            self.best[setting] = min((time.thread_time() - began) / self.steps, self.best.get(setting, np.inf))

    def errors(self):
        setting = min(self.best, key=self.best.get)
        data = self.fresh(setting)
        least = lambda: min(0.0, data.contact.dist.min()) if data.ncon else 0.0

        def momentum():
            mujoco.mj_subtreeVel(self.model, data)
            return data.subtree_linvel[0] * self.model.body_subtreemass[0]

        start, overlap, slip, energies, met = least(), 0.0, 0.0, [], 0
        x, p, change = data.qpos[:2].copy(), momentum(), 0.0
        size = sum(np.linalg.norm(v[:3]) for v in data.qvel.reshape(-1, 6)) if self.kind == "alone" else 1
        for _ in range(self.steps):
            mujoco.mj_step(self.model, data)
            met = max(met, data.ncon)
            overlap = max(overlap, start - least())
            slip = max(slip, np.linalg.norm(data.qpos[:2] - x)) if self.kind == "rests" else 0
            change = max(change, np.linalg.norm(momentum() - p) / size)
            energies.append(data.energy.sum())
        return overlap, slip, growth(energies), change, ", ".join(setting), met


def chain_of(theirs):
    """MuJoCo's chain, joint by joint."""

    def turned(quaternion):
        out = np.zeros(9)
        mujoco.mju_quat2Mat(out, quaternion)
        return out.reshape(3, 3)

    builder = dyn.Builder("chain")
    for i in range(1, theirs.nbody):
        placement = np.eye(4)
        placement[:3, :3], placement[:3, 3] = turned(theirs.body_quat[i]), theirs.body_pos[i]
        builder.add_joint(f"joint{i}", "revolute", f"joint{i - 1}" if i > 1 else None, placement, axis=theirs.jnt_axis[i - 1])
        R = turned(theirs.body_iquat[i])
        builder.add_body(f"link{i}", f"joint{i}", theirs.body_mass[i], theirs.body_ipos[i],
                         R @ np.diag(theirs.body_inertia[i]) @ R.T)
    return builder.finish()


SETTINGS = {
    "default": {},
    "pgs 1e-3": {"solver": "pgs", "tolerance": 1e-3, "max_iterations": 50},
    "pgs 1e-2": {"solver": "pgs", "tolerance": 1e-2, "max_iterations": 50},
    "pgs 1e-1": {"solver": "pgs", "tolerance": 1e-1, "max_iterations": 10},
    "half steps": {},
}
CHAINS = ("default", "half steps")  # where no rows act there is nothing to solve
ROUND_OFF = (1e-9, 1e-9, 1e-9, 1e-12)  # of overlap, slip, energy, momentum


class Libdyn:
    def __init__(self, model, steps, kind, dt, setting):
        self.model, self.steps, self.kind, self.dt, self.setting, self.best = model, steps, kind, dt, setting, np.inf
        self.parts = 2 if setting == "half steps" else 1

    def fresh(self):
        model, named = self.model, "qpos0" in self.model.configuration_names
        data = model.data(dyn.Part.SIMULATION | dyn.Part.ENERGY | dyn.Part.CENTROIDAL)
        data.set_effects(dyn.Effect.ALL & ~dyn.Effect.SLEEPING)  # MuJoCo does not let them sleep either
        q = model.configuration("qpos0") if named else model.neutral()
        v = np.hstack([np.append(-2 * x[:3], (0, 0, 0)) for x in q.reshape(-1, 7)]) if self.kind == "alone" else None
        data.set_state(q, v)
        data.set_step_options("semi_implicit_euler", self.dt / self.parts, **SETTINGS[self.setting])
        return data

    def time(self):
        data = self.fresh()
        began = time.thread_time()
        data.advance(self.steps * self.dt)
        self.best = min(self.best, (time.thread_time() - began) / self.steps)

    def errors(self):
        data, overlap, slip, energies, change, missed, residual, met = self.fresh(), 0.0, 0.0, [], 0.0, 0, 0.0, 0
        momentum = lambda: np.array(data.centroidal_momentum(data.q, data.v)[:3])
        x, p = np.array(data.q[:2]), momentum()
        size = sum(np.linalg.norm(v[:3]) for v in np.array(data.v).reshape(-1, 6)) if self.kind == "alone" else 1
        for k in range(self.steps):
            data.advance(self.dt)
            report = data.step_report
            met = max(met, report.contacts)
            start = report.penetration if k == 0 else start
            overlap = max(overlap, report.penetration - start)
            residual, missed = max(residual, report.residual), missed + (report.residual > 1e-4)
            slip = max(slip, np.linalg.norm(np.array(data.q[:2]) - x)) if self.kind == "rests" else 0
            change = max(change, np.linalg.norm(momentum() - p) / size) if self.kind == "alone" else 0
            energies.append(sum(data.energy()))
        return overlap, slip, growth(energies), change, residual, missed, met


def plot(rows, path):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "dyn", "font.family": "sans-serif", "font.size": 9})
    fig, ax = plt.subplots(figsize=(8.2, 0.8 + 0.28 * len(rows)), layout="constrained", facecolor="white")
    names, ratios = [r[0] for r in rows], [r[1] for r in rows]
    ax.barh(names, ratios, color=["#2a8f62" if r <= 0.67 else "#d1603d" for r in ratios], height=0.6)
    for k, r in enumerate(ratios):
        ax.text(r, k, f" {r:.2f}", va="center", fontsize=8)
    ax.axvline(1, color="#b3261e", lw=0.9)
    ax.axvline(0.67, color="#24292f", lw=0.9, ls=(0, (4, 2)))
    ax.invert_yaxis()
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(length=0)
    ax.set_xlabel("time of a step of libdyn / MuJoCo's at its fastest setting")
    fig.savefig(path, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join([*SCENES, *HUMANOIDS])}; default all")
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--dt", type=float, default=0.002)
    parser.add_argument("--passes", type=int, default=3)
    parser.add_argument("--humanoids", type=Path, metavar="FOLDER")
    parser.add_argument("--linear", action="store_true")
    parser.add_argument("--plot", type=Path, metavar="FILE")
    options = parser.parse_args()
    scenes = dict(LINEAR if options.linear else SCENES)
    if options.humanoids and not options.linear:
        scenes |= {name: (options.humanoids / file, DOWN, "") for name, file in HUMANOIDS.items()}
    unknown = set(options.scenes) - set(scenes)
    if unknown:
        parser.error(f"no such scene{'' if options.humanoids else ' without --humanoids'}: {', '.join(sorted(unknown))}")
    print(f"libdyn: {dyn.library_path}", file=sys.stderr)
    steps, rows = round(options.seconds / options.dt), []
    print("| scene | MuJoCo, us | its setting | libdyn, us | its setting | ratio | default | overlap, m | | slip, m | | energy "
          "grown, J | | momentum | | residual, default | steps above 1e-4 |")
    print("|---" * 17 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scenes or scenes:
            world, gravity, kind = scenes[name]
            path = Path(folder) / "scene.xml"
            if kind == "chain":
                spec = chain(world)
                spec.option.timestep, spec.option.enableflags = options.dt, int(mujoco.mjtEnableBit.mjENBL_ENERGY)
                model = spec.compile()
            else:
                path.write_text(humanoid_text(world, options.dt) if isinstance(world, Path)
                                else scene_text(world, options.dt, gravity))
                model = mujoco.MjModel.from_xml_path(str(path))
            theirs, mine = Mujoco(model, steps, kind), chain_of(model) if kind == "chain" else dyn.load(str(path))
            ours = [Libdyn(mine, steps, kind, options.dt, setting) for setting in SETTINGS
                    if kind != "chain" or setting in CHAINS]
            for _ in range(options.passes):
                theirs.time(), [our.time() for our in ours]
            their, errors = theirs.errors(), {our.setting: our.errors() for our in ours}
            no_less = lambda our: all(e <= max(t, least) for e, t, least in zip(errors[our.setting], their, ROUND_OFF))
            if not any(map(no_less, ours)):
                print(f"| {name} | {their} | {errors} | no setting is as exact |", flush=True)
                continue
            chosen, least = min(filter(no_less, ours), key=lambda our: our.best), min(theirs.best.values())
            my = errors[chosen.setting]
            rows.append((name, chosen.best / least))
            shown = lambda k, only: (f"{their[k]:.1g}", f"{my[k]:.1g}") if not only or kind == only else ("", "")
            cells = [x for k, only in enumerate(("", "rests", "", "alone")) for x in shown(k, only)]
            print(f"| {name} | {1e6 * least:.3g} | {their[4]} | {1e6 * chosen.best:.3g} | {chosen.setting} | {chosen.best / least:.2f} | {ours[0].best / least:.2f} "
                  f"| {' | '.join(cells)} | {errors['default'][4]:.1g} | {errors['default'][5]} of {steps} |", flush=True)
    if options.plot:
        plot(rows, options.plot)


if __name__ == "__main__":
    main()
