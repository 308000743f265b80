"""Scenes drawn from a seed: masses from 1e-6 to 1e6 kg, deep overlaps, loops, huge gains, steps from 1e-5 to 0.05 s, every
integrator and solver."""

import math
import re
from typing import NamedTuple

import numpy as np

import libdyn as dyn
from libdyn import constraint as dc

INTEGRATORS = ("semi_implicit_euler", "implicit_fast", "rk4", "implicit_midpoint", "rk45", "reference")
SOLVERS = ("admm", "pgs", "newton")
KINDS = ("heap", "tree", "loop", "servo", "springs")
GRAVITY = 9.81
# Of the energy that was there: a larger gain is not explained. Steps of order 1 let the energy of an oscillation swing by h w / 2.
SHARE = 0.5
MAX_ITERATIONS = 100  # the default of step options
# Of the energy at the start: what sums of large energies leave.
ROUNDING = 1e-12


def log_uniform(random, low, high):
    return 10 ** random.uniform(np.log10(low), np.log10(high))


def rotation(random, angle=None):
    """About a random axis; angle None: any."""
    a = random.normal(size=3)
    a *= (random.uniform(0, np.pi) if angle is None else angle) / np.linalg.norm(a)
    K = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    t = np.linalg.norm(a)
    return np.eye(3) + np.sinc(t / np.pi) * K + 0.5 * np.sinc(t / (2 * np.pi)) ** 2 * K @ K


class Scene(NamedTuple):
    seed: int
    kind: str
    data: object
    steps: int
    motors: np.ndarray  # force of each motor on its coordinate
    servos: list  # (coordinate, kp, target) of each servo

    def energy(self, start):
        """Kinetic, potential, and that of servos, less the work of motors since the start."""
        d = self.data
        stored = sum(0.5 * kp * (target - d.q[i]) ** 2 for i, kp, target in self.servos)
        driven = float(self.motors @ d.model.difference(start, d.q)) if self.motors.any() else 0.0
        return d.energy().kinetic + d.energy().potential + stored - driven


def add_link(b, random, k, parent, length, mass, type, collides, more):
    name = f"link{k}"
    half = length * random.uniform(0.1, 0.5, 3)
    half[0] = length / 2
    place = None if parent is None else (rotation(random), (length * random.uniform(0.2, 1), 0, 0))
    values = dict(axis=random.normal(size=3)) if type in ("revolute", "prismatic") else {}
    b.add_joint(f"joint{k}", type, parent, place, **values, **more)
    inertia = mass / 3 * np.diag([half[1] ** 2 + half[2] ** 2, half[0] ** 2 + half[2] ** 2, half[0] ** 2 + half[1] ** 2])
    b.add_body(name, f"joint{k}", mass, (0, 0, 0), inertia)
    if collides:
        restitution = random.choice([0.0, 0.0, 0.0, 0.5, 1.0])
        stiffness = random.choice([0.0, 0.0, 0.0, log_uniform(random, 1, 1e8)])
        material = dyn.Material(friction=random.choice([0.0, 0.3, 1.0, 5.0]), restitution=restitution, stiffness=stiffness)
        shape = random.choice(["box", "sphere", "capsule"])
        size = {"box": 2 * half, "sphere": (half[1],), "capsule": (half[1], half[0])}[shape]
        b.add_shape(name, shape, size, name=f"shape{k}", material=material)
    return name


def scene(seed):
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    b = dyn.Builder(f"{kind}{seed}")
    ground = random.random() < 0.7 or kind == "heap"
    if ground:
        b.add_shape("universe", "half_space", name="ground", material=dyn.Material(friction=random.choice([0.0, 0.5, 1.0])))
    # corrections of overlaps would wind up servos
    collides = kind == "heap" or (random.random() < 0.6 and kind != "servo")
    n = int(random.integers(2, 9))
    length = log_uniform(random, 0.01, 1)
    ratio = random.choice([1.0, 1e2, 1e6])  # of the masses
    mass = log_uniform(random, 1e-6, 1e6)
    masses = [float(np.clip(mass * log_uniform(random, 1 / ratio, ratio), 1e-6, 1e6)) for _ in range(n)]
    parents, floating = [], random.random() < 0.3
    for k in range(n):
        if kind == "heap":
            parent, type = None, "free_flyer"
        else:
            parent = None if k == 0 else parents[-1] if random.random() < 0.8 else parents[int(random.integers(k))]
            type = "free_flyer" if k == 0 and floating else random.choice(["revolute", "revolute", "revolute", "prismatic", "spherical"])
        more = {}
        if kind == "springs" and type != "free_flyer":
            values = log_uniform(random, 1e-2, 1e8), random.choice([0.0, log_uniform(random, 1e-4, 1e6)])
            more["stiffness"], more["damping"] = ((x,) * 3 if type == "spherical" else x for x in values)
        parents.append(add_link(b, random, k, parent, length, masses[k], str(type), collides, more))
    motors, servos = [], []
    m = b.finish()
    if kind == "servo":
        for k, joint in enumerate(m.joints[1:]):
            if joint.nv != 1:
                continue
            scale = masses[k] * length * GRAVITY
            if random.random() < 0.3:
                b.add_actuator(f"motor{k}", joint.name, type="motor")
                motors.append((k, joint.idx_v, scale * log_uniform(random, 1e-2, 1e2)))
            else:
                kp = log_uniform(random, 1e-2, 1e8)
                kv = float(random.choice([0.0, kp * 1e-3, kp]))
                b.add_actuator(f"servo{k}", joint.name, type="position", kp=kp, kv=kv)
                servos.append((joint.idx_q, kp, random.uniform(-1, 1)))
        m = b.finish()
    q = m.random(seed=seed)
    for joint in m.joints[1:]:
        if joint.nq == 7:
            q[joint.idx_q : joint.idx_q + 3] = length * random.uniform(-1, 1, 3) * (0.5, 0.5, 0.5)
    if kind == "loop":
        d = m.data()
        d.forward_kinematics(q)
        for _ in range(int(random.integers(1, 4))):
            first = parents[int(random.integers(n))]
            at = d.frame_placement(first)
            off = rotation(random, float(random.choice([0.0, log_uniform(random, 1e-12, 1e-2)])))
            closing = random.choice(["connect", "weld", "loop"])
            place = (at.rotation @ off, at.translation)
            if closing == "loop":
                c = dc.loop("revolute", first, None, axis=random.normal(size=3), placement2=place)
            else:
                c = getattr(dc, closing)(first, None, placement2=place)
            b.add_constraint(f"closing{len(m.joints)}{_}", c)
        m = b.finish()
    d = m.data()
    d.set_effects(dyn.Effect.ALL & ~dyn.Effect.SLEEPING)
    d.q, d.v = q, (0 if random.random() < 0.3 else log_uniform(random, 1e-3, 10)) * random.normal(size=m.nv)
    force = np.zeros(m.nv)
    u = np.zeros(m.nu)
    order = [("motor", x) for x in motors] + [("servo", x) for x in servos]
    for a, name in enumerate(m.actuator_names):
        j = int(name[5:])
        joint = m.joints[j + 1]
        if name.startswith("motor"):
            u[a] = next(x[2] for x in motors if x[0] == j)
            force[joint.idx_v] = u[a]
        else:
            u[a] = next(x[2] for x in servos if x[0] == joint.idx_q)
    if m.nu:
        d.set_control(u)
    integrator = str(random.choice(INTEGRATORS, p=(0.4, 0.2, 0.1, 0.1, 0.1, 0.1)))
    d.set_step_options(integrator, log_uniform(random, 1e-5, 0.05), solver=str(random.choice(SOLVERS)), ledger=True)
    return Scene(seed, kind, d, 100, force, servos)


class Result(NamedTuple):
    refusal: str  # reason of the error that ended it, without names and numbers; "": none
    steps: int
    finite: bool
    gain: float  # J: largest energy above that of the start, with what corrections and springs of contacts gave
    scale: float  # J: energy that the scene had or was given
    beyond: int  # iterations of a step beyond max_iterations for each island and evaluation; 0: none


def reason(error):
    """The message without names and numbers."""
    return re.sub(r"\s+", " ", re.sub(r"'[^']*'|[-+]?\d[-+.e\d]*", "", str(error))).strip()


def soft_energy(d):
    """Energy of the contacts' springs at the beginning of the last step."""
    sum = 0.0
    for c in d.step_contacts():
        materials = d.shape_material(c.contact.shape_a), d.shape_material(c.contact.shape_b)
        springs = [x.stiffness for x in materials if x.stiffness > 0]
        if springs and c.contact.distance < 0:
            sum += 0.5 / math.fsum(1 / x for x in springs) * c.contact.distance**2
    return sum


def play(scene):
    """Steps, and what the energy did. Overlaps and drift that are removed lift bodies and stretch springs: that energy is explained."""
    d = scene.data
    start = d.q.copy()
    first = scene.energy(start)
    colliding = [k for k, shape in enumerate(d.model.shapes) if shape.role == dyn.ShapeRole.COLLISION]
    soft = any(d.shape_material(k).stiffness > 0 for k in colliding)
    kinetic, lowest, given, gain, finite, beyond = d.energy().kinetic, first, 0.0, 0.0, True, 0
    for k in range(scene.steps):
        try:
            d.step()
        except dyn.NumericError as error:
            finite = finite and bool(np.isfinite(d.q).all() and np.isfinite(d.v).all())
            return Result(reason(error), k, finite, gain, kinetic + first - lowest + given, beyond)
        ledger, report = d.ledger, d.step_report
        beyond = max(beyond, report.iterations - MAX_ITERATIONS * report.islands * max(1, report.evaluations))
        given += max(0.0, ledger.correction) + (soft_energy(d) if k == 0 else 0.0)
        if soft:
            given += max(0.0, ledger.contact_normal)
        energy = scene.energy(start)
        finite = finite and bool(np.isfinite(d.q).all() and np.isfinite(d.v).all() and np.isfinite(energy))
        lowest = min(lowest, energy - d.energy().kinetic)
        gain = max(gain, energy - first - given - ROUNDING * abs(first))
    return Result("", scene.steps, finite, gain, kinetic + first - lowest + given, beyond)
