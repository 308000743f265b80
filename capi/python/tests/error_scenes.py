"""Scenes drawn from a seed whose motion is known: chains, chains that fall on a floor, bodies that fall on it and slide."""

from typing import NamedTuple

import numpy as np

import libdyn as dyn

METHODS = ("semi_implicit_euler", "implicit_fast", "rk4", "implicit_midpoint", "accuracy")
FLOOR = '<geom type="plane" size="5 5 1"/>'


class Run(NamedTuple):
    kind: str
    method: str
    error: float
    """Of the largest coordinate: by steps for an accuracy of 1e-6."""
    bar: dyn.ErrorBar


def shape(random):
    a, b, c = 0.12 * random.uniform(0.5, 1.5, 3)
    return random.choice([f'type="box" size="{a} {b} {c}"', f'type="sphere" size="{a}"', f'type="capsule" size="{a / 2} {b}"',
                          f'type="cylinder" size="{a} {0.7 * b}"'])


def chain(random, links, height, free):
    text = ""
    for k in reversed(range(links)):
        x, y, z = random.normal(size=3)
        joint = (f'<joint axis="{x} {y} {z}" damping="{random.uniform(0, 0.3)}" stiffness="{random.choice([0, 0, 5])}"/>'
                 if k or not free else "<freejoint/>")
        text = (f'<body pos="{f"0 0 {height}" if k == 0 else "0 0 -0.3"}">{joint}<geom type="capsule" fromto="0 0 0 0 0 -0.3" '
                f'size="0.04" contype="{int(free)}" conaffinity="{int(free)}"/>{text}</body>')
    return text


def bodies(random):
    text = ""
    for k in range(random.integers(1, 4)):
        x, y, z = random.uniform(0, 360, 3)
        text += (f'<body pos="{0.8 * k} 0 {random.uniform(0.15, 0.8)}" euler="{x} {y} {z}"><freejoint/>'
                 f'<geom {shape(random)} friction="{random.uniform(0.2, 1)}"/></body>')
    return text


def scene(seed):
    """The kind, the model, a state, a duration, a method, its dt and accuracy."""
    random = np.random.default_rng(seed)
    kind = str(random.choice(["chain", "free chain", "bodies"]))
    links = int(random.integers(1, 6))
    world = FLOOR + (bodies(random) if kind == "bodies" else chain(random, links, 0.3 * links + 0.2, kind != "chain"))
    model = dyn.load_string(f"<mujoco><worldbody>{world}</worldbody></mujoco>")
    q = model.configuration("qpos0").copy() if "qpos0" in model.configuration_names else model.neutral()
    return (kind, model, q, random.normal(size=model.nv), random.uniform(0.2, 1), str(random.choice(METHODS)),
            float(random.choice([5e-4, 1e-3, 2e-3, 5e-3])), 10 ** random.uniform(-6, -2))


class TooMany(Exception):
    """Evaluations: contact that opens and closes at every step."""


def advanced(model, q, v, duration, **options):
    data = model.data(dyn.Part.SIMULATION)
    data.set_state(q, v)
    data.set_step_options(**options)
    if "accuracy" not in options:
        data.advance(duration)
        return data
    for _ in range(100):
        data.advance(duration / 100)
        if data.step_report.evaluations > 20000:
            raise TooMany
    return data


def run(seed):
    """None: a scene that is refused, or whose error is not known to a fiftieth."""
    kind, model, q, v, duration, method, dt, accuracy = scene(seed)

    def at(finer):
        if method == "accuracy":
            return advanced(model, q, v, duration, dt=0.1, accuracy=accuracy / finer**3)
        return advanced(model, q, v, duration, integrator=method, dt=dt / finer)

    try:
        data, finer = at(1), at(2)
        exact, known = (advanced(model, q, v, duration, dt=0.1, accuracy=a) for a in (1e-6, 1e-5))
    except (dyn.Error, TooMany):
        return None

    def apart(a, b):
        return float(np.abs(model.difference(a.q, b.q)).max())

    error = apart(data, exact)
    return Run(kind, method, error, data.error_bar(finer)) if apart(known, exact) <= max(0.02 * error, 1e-12) else None
