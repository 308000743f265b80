"""An MJCF model here and in MuJoCo: forces at random states, and the motion of the simulation under held controls.

motion() compares with MuJoCo as the file is. rigid_motion() compares with MuJoCo's limit of rigid contacts, limits and
equalities, from a pose at which none of them is violated: there both have the same law of contact.
"""

import contextlib
import copy
from typing import NamedTuple

import mujoco
import numpy as np

import libdyn as dyn

MOVES = 0.06  # rad or m: within the peer's contact model
FORCES = 1e-9  # relative
PARTS = ("M", "bias", "passive", "actuators")


class Beside:
    """A model and its peer: states and forces of one in the coordinates of the other."""

    def __init__(self, mm, m):
        self.mm, self.m = mm, m
        free = mm.jnt_type == mujoco.mjtJoint.mjJNT_FREE
        ball = mm.jnt_type == mujoco.mjtJoint.mjJNT_BALL
        self.free = mm.jnt_dofadr[free]
        self.quaternions = np.r_[mm.jnt_qposadr[free] + 3, mm.jnt_qposadr[ball]]

    def q(self, qpos):
        """qpos with quaternions (x, y, z, w)."""
        q = np.array(qpos)
        for k in self.quaternions:
            q[k : k + 4] = np.roll(q[k : k + 4], -1)
        return q

    def qpos(self, q):
        qpos = np.array(q)
        for k in self.quaternions:
            qpos[k : k + 4] = np.roll(qpos[k : k + 4], 1)
        return qpos

    def velocity_map(self, qpos):
        """T with v = T qvel: the linear velocity of a free joint in the body's axes."""
        T = np.eye(self.mm.nv)
        for j in np.flatnonzero(self.mm.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
            R, k, a = np.empty(9), self.mm.jnt_dofadr[j], self.mm.jnt_qposadr[j]
            mujoco.mju_quat2Mat(R, qpos[a + 3 : a + 7])
            T[k : k + 3, k : k + 3] = R.reshape(3, 3).T
        return T

    def apart(self, a, b):
        """Largest difference of two configurations, m or rad."""
        d = np.zeros(self.mm.nv)
        mujoco.mj_differentiatePos(self.mm, d, 1.0, a, b)
        return float(np.abs(d).max(initial=0))


def relative(ours, theirs, least):
    return float(np.abs(ours - theirs).max(initial=0) / max(np.abs(theirs).max(initial=0), least, 1e-12))


def links_forces(m, d, q, v, h):
    """Drag of the medium and gravity compensation, which act in steps alone: M times their part of a step, at the limit h = 0.

    From steps of h to 5 h: a small h rounds more, a large one resolves strong drag less."""

    def after_step(h, *effects):
        d.set_effects(("armature", *effects))
        d.set_step_options("semi_implicit_euler", dt=h)
        d.set_state(q, v, np.zeros(m.nv), np.zeros(m.nv))
        d.step()
        return d.v.copy()

    def acceleration(h):
        return (after_step(h, "fluid", "fluid_ellipsoids", "gravity_compensation") - after_step(h)) / h

    a = sum(c * acceleration((k + 1) * h) for k, c in enumerate((5, -10, 10, -5, 1)))
    d.set_effects("armature")
    return d.crba(q) @ a


def carriers(m, frame):
    """Degrees of freedom that move a frame."""
    joint, out = m.frames[frame].joint, set()
    while joint > 0:
        j = m.joints[joint]
        out.update(range(j.idx_v, j.idx_v + j.nv))
        joint = j.parent
    return out


def moment_arms(m, d, q, a, tendons):
    """Of an actuator: what a unit force gives the degrees of freedom. tendons: their moment arms."""
    out = np.zeros(m.nv)
    if a.transmission == dyn.Transmission.TENDON:
        return a.gear * tendons[a.tendon]
    if a.transmission == dyn.Transmission.JOINT:
        out[m.joints[a.joint].idx_v + a.component] = a.gear
        return out
    d.forward_kinematics(q)
    axes = np.kron(np.eye(2), d.frame_placement(a.frame if a.reference < 0 else a.reference).rotation)
    out = d.frame_jacobian(a.frame, "local_world_aligned").T @ axes @ np.array(a.wrench)
    if a.reference >= 0:
        out -= d.frame_jacobian(a.reference, "local_world_aligned").T @ axes @ np.array(a.wrench)
        out[list(carriers(m, a.frame) & carriers(m, a.reference))] = 0
    return out


def actuator_forces(m, d, q, v, ctrl):
    """Forces on the degrees of freedom: those at the end of a step that is too short to change the state."""
    if not m.nactuators:
        return np.zeros(m.nv)
    d.reset()
    d.set_effects(("armature", "actuators"))
    d.set_step_options("semi_implicit_euler", dt=1e-20)
    d.set_state(q, v, np.zeros(m.nv), np.zeros(m.nv))
    d.set_control(ctrl)
    d.step()
    forces = d.field("actuator_force").copy()
    tendons = d.tendons(q, v)[2] if m.ntendons else None
    return sum((force * moment_arms(m, d, q, m.actuator(k), tendons) for k, force in enumerate(forces)), np.zeros(m.nv))


def tendon_forces(m, d, q, v):
    """Of their springs and dampers."""
    length, velocity, J = d.tendons(q, v)
    out = np.zeros(m.nv)
    for k in range(m.ntendons):
        t = m.tendon(k)
        out += J[k] * (t.stiffness * (np.clip(length[k], *t.rest) - length[k]) - t.damping * velocity[k])
    return out


def random_state(beside, md, random):
    mm = beside.mm
    mujoco.mj_resetData(mm, md)
    mujoco.mj_integratePos(mm, md.qpos, random.uniform(-1, 1, mm.nv), 0.5)
    md.qvel[:] = random.uniform(-1, 1, mm.nv)
    ranges = np.where(mm.actuator_ctrllimited[:, None], mm.actuator_ctrlrange, (-1, 1)).reshape(-1, 2)
    md.ctrl[:] = random.uniform(ranges[:, 0], ranges[:, 1])
    mujoco.mj_forward(mm, md)


def forces(beside, states=5):
    """{part: largest relative difference at random states}."""
    mm, m = beside.mm, beside.m
    md, d, random, worst = mujoco.MjData(mm), m.data(), np.random.default_rng(1), dict.fromkeys(PARTS, 0.0)
    stated = d.effects()
    d.set_shape_masks(None, 0, 0)
    for pair in range(m.npairs):
        d.set_pair(pair, False)
    for k in range(m.nconstraints):
        d.set_constraint_enabled(k, False)
    full = np.empty((mm.nv, mm.nv))
    for _ in range(states):
        random_state(beside, md, random)
        mujoco.mj_fullM(mm, md, full)
        T, q = beside.velocity_map(md.qpos), beside.q(md.qpos)
        v, zero = T @ md.qvel, np.zeros(mm.nv)
        for k in beside.free:  # MuJoCo's zero acceleration, in the body's axes
            zero[k : k + 3] = -np.cross(v[k + 3 : k + 6], v[k : k + 3])
        d.set_effects("armature")
        M, bias = d.crba(q), d.rnea(q, v, zero)
        d.set_effects(("armature", *(e.name.lower() for e in (dyn.Effect.DAMPING, dyn.Effect.SPRINGS) if e in stated)))
        passive = bias - d.rnea(q, v, zero)
        if stated & (dyn.Effect.FLUID | dyn.Effect.FLUID_ELLIPSOIDS | dyn.Effect.GRAVITY_COMPENSATION):
            ways = [passive + links_forces(m, d, q, v, h) for h in (1e-5, 1e-4, 1e-3)]
            passive = min(ways, key=lambda way: np.abs(T.T @ way - md.qfrc_passive).max())
        if dyn.Effect.TENDONS in stated:
            passive = passive + tendon_forces(m, d, q, v)
        driven = actuator_forces(m, d, q, v, md.ctrl) if dyn.Effect.ACTUATORS in stated else np.zeros(mm.nv)
        least = 1e-3 * max(np.abs(md.qfrc_bias).max(initial=0), np.abs(full).max(initial=0))
        pairs = (
            (T.T @ M @ T, full),
            (T.T @ bias, md.qfrc_bias),
            (T.T @ passive, md.qfrc_passive),
            (T.T @ driven, md.qfrc_actuator),
        )
        for part, (ours, theirs) in zip(PARTS, pairs):
            worst[part] = max(worst[part], relative(ours, theirs, 0 if part == "M" else least))
    return worst


class Run:
    """Configurations, energies and bodies in contact of MuJoCo's steps, from where the file draws or from a Start."""

    def __init__(self, mm, duration, refine=1, start=None):
        before = mm.opt.timestep
        mm.opt.timestep, mm.opt.enableflags = before / refine, mm.opt.enableflags | mujoco.mjtEnableBit.mjENBL_ENERGY
        md, self.qpos = begin(mm, start), []
        self.energy, self.kinetic = [md.energy.sum()], [md.energy[1]]
        for _ in range(max(round(duration / before), 1)):
            for _ in range(refine):
                mujoco.mj_step(mm, md)
            self.qpos.append(md.qpos.copy())
            self.energy.append(md.energy.sum()), self.kinetic.append(md.energy[1])
        mm.opt.timestep = before
        pairs = mm.geom_bodyid[[c.geom for c in md.contact if c.dist < c.includemargin]].reshape(-1, 2)
        self.touching = {frozenset((name_of(mm, a), name_of(mm, b))) for a, b in pairs}


def begin(mm, start=None):
    md = mujoco.MjData(mm)
    if start:
        if start.key is not None:
            mujoco.mj_resetDataKeyframe(mm, md, start.key)
        md.qpos[:] = start.qpos
    mujoco.mj_forward(mm, md)
    return md


@contextlib.contextmanager
def stiffer(mm):
    """Time constants of contacts, limits and equalities are half as long."""
    times = [
        getattr(mm, name)[:, 0]
        for name in ("geom_solref", "jnt_solref", "dof_solref", "eq_solref", "pair_solref", "tendon_solref_lim")
    ]
    for x in times:
        x[x > 0] /= 2
    yield
    for x in times:
        x[x > 0] *= 2


def name_of(mm, body):
    """Of a body, or of the world that it is welded to."""
    return "world" if mm.body_weldid[body] == 0 else mm.body(mm.body_weldid[body]).name or f"body_{mm.body_weldid[body]}"


def distances(beside, peer, sim, steps=1):
    """Of the configurations, after some steps of the simulation for each of the peer's."""
    out = []
    for qpos in peer.qpos:
        sim.step(steps)
        out.append(beside.apart(qpos, beside.qpos(sim.q)))
    return out


def motion(beside, duration):
    """The motion here beside MuJoCo's: {"moves", "itself", "energy", "contacts"}.

    moves: largest distance of the configurations. itself: where that is more than MOVES, MuJoCo's distance from its own motion
    with half the timestep, or with contacts and limits twice as stiff, the larger. energy: difference of the energies at the end,
    over the largest change or kinetic energy of MuJoCo's run. contacts: share of the pairs of bodies in contact at the end that
    both have.
    """
    mm, m = beside.mm, beside.m
    peer, sim = Run(mm, duration), dyn.Simulation(m)
    data = m.data()
    data.set_effects("all")

    def energy():
        return sum(data.energy(sim.q, sim.v))

    begin, out = energy(), {"moves": max(distances(beside, peer, sim))}
    if out["moves"] <= MOVES:
        return out
    with stiffer(mm):
        stiff = Run(mm, duration, 4)
    out["itself"] = max(beside.apart(a, b) for other in (Run(mm, duration, 2), stiff) for a, b in zip(peer.qpos, other.qpos))
    E = np.array(peer.energy)
    scale = max(np.abs(E - E[0]).max(), np.max(peer.kinetic))
    out["energy"] = abs((energy() - begin) - (E[-1] - E[0])) / max(scale, 1e-12)
    touching = {
        frozenset((body_of(m, c.contact.shape_a), body_of(m, c.contact.shape_b)))
        for c in sim.data.step_contacts()
        if c.contact.distance < 1e-3
    }
    every = len(touching | peer.touching)
    out["contacts"] = len(touching & peer.touching) / every if every else 1.0
    return out


def body_of(m, shape):
    """Name of the moving link that carries a shape, or "world"."""
    frame = m.shapes[shape].frame
    joint = m.frames[frame].joint
    if joint == 0:
        return "world"
    return next(f.name for f in m.frames if f.joint == joint and f.type is dyn.FrameType.BODY)


class Start(NamedTuple):
    name: str  # "drawn", or a key's; "raised": moved by within_limits(); "closed": equalities hold by closed()
    key: int | None
    qpos: np.ndarray


def within_limits(mm, qpos):
    """Moved to the nearest limits, and with its free bodies raised out of the deepest overlap."""
    q = np.array(qpos)
    for j in np.flatnonzero(mm.jnt_limited & (mm.jnt_type >= 2)):
        q[mm.jnt_qposadr[j]] = np.clip(q[mm.jnt_qposadr[j]], *mm.jnt_range[j])
    md = begin(mm, Start("", None, q))
    deepest = min((c.dist - c.includemargin for c in md.contact), default=0.0)
    q[mm.jnt_qposadr[mm.jnt_type == mujoco.mjtJoint.mjJNT_FREE] + 2] -= min(deepest, 0.0)
    return q


def violated(mm, start):
    """Whether contacts overlap by more than 1 mm, joints are beyond limits by 1 (mm, mrad), or equalities off by 0.1."""
    md = begin(mm, start)
    q = md.qpos[mm.jnt_qposadr]
    beyond = np.where(mm.jnt_limited & (mm.jnt_type >= 2), np.maximum(mm.jnt_range[:, 0] - q, q - mm.jnt_range[:, 1]), 0)
    opened = np.abs(md.efc_pos[md.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY])
    deepest = min((c.dist - c.includemargin for c in md.contact), default=0.0)
    return deepest < -1e-3 or beyond.max(initial=0) > 1e-3 or opened.max(initial=0) > 1e-4


def closed(beside, start):
    """The nearest pose at which the equalities hold, raised."""
    mm, d = beside.mm, beside.m.data()
    q = d.project(beside.q(start.qpos), np.zeros(mm.nv)).q
    return start._replace(name=start.name + ", closed", qpos=within_limits(mm, beside.qpos(q)))


def sound_start(beside):
    """The first pose of the file at which nothing is violated, as it is, raised or closed; None if there is none."""
    mm = beside.mm
    written = [Start("drawn", None, mm.qpos0)]
    written += [Start(mm.key(k).name or f"key {k}", k, mm.key_qpos[k]) for k in range(mm.nkey) if not mm.key_act[k].any()]
    raised = [s._replace(name=s.name + ", raised", qpos=within_limits(mm, s.qpos)) for s in written]
    starts = written + raised + ([closed(beside, s) for s in written + raised] if mm.neq and beside.m.nconstraints else [])
    return next((s for s in starts if not violated(mm, s)), None)


def rigid(mm, faster=16):
    """A copy with contacts, limits, friction and equalities so many times as fast, without rebound or compliance, with round
    cones."""
    out = copy.copy(mm)
    for name in ("geom", "jnt", "dof", "eq", "pair"):
        law, impedance = getattr(out, name + "_solref"), getattr(out, name + "_solimp")
        standard = law[:, 0] > 0
        law[standard] *= (1 / faster, 3)  # time constant, damping ratio
        law[~standard] *= (faster**2, 3 * faster)  # stiffness, damping
        impedance[:, :2] = 1 - 1e-4
    out.opt.cone, out.opt.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, max(out.opt.impratio, 10)
    out.opt.iterations, out.opt.ls_iterations, out.opt.tolerance = 200, 50, 1e-12
    return out


def rigid_motion(beside, duration):
    """The motion here beside rigid() MuJoCo's, both in fine steps from sound_start(), {} without one:
    {"start", "rigid", "until", "own"}.

    rigid: largest distance of the configurations. until: the time at which it is first beyond MOVES. own: the time at which
    MuJoCo's own motion is, when everything is twice as fast.
    """
    mm, start = beside.mm, sound_start(beside)
    if not start:
        return {}
    sim, md = dyn.Simulation(beside.m, dt=mm.opt.timestep / 4, tolerance=1e-8), begin(mm, start)
    sim.data.set_state(beside.q(md.qpos), beside.velocity_map(md.qpos) @ md.qvel)
    if mm.nu:
        sim.data.set_control(md.ctrl)
    peer = Run(rigid(mm), duration, 32, start)
    away = distances(beside, peer, sim, 4)
    out = {"start": start.name, "rigid": max(away)}
    if max(away) > MOVES:
        twice = Run(rigid(mm, 32), duration, 64, start)
        own = [beside.apart(a, b) for a, b in zip(peer.qpos, twice.qpos)]
        first = {what: next((k for k, x in enumerate(far) if x > MOVES), None) for what, far in (("until", away), ("own", own))}
        out |= {what: k * mm.opt.timestep for what, k in first.items() if k is not None}
    return out


def beginning(mm):
    """What of the drawn pose explains a motion that differs: (joints beyond their limits, contacts deeper than 1 mm)."""
    md = mujoco.MjData(mm)
    mujoco.mj_forward(mm, md)
    beyond = [
        mm.joint(j).name
        for j in np.flatnonzero(mm.jnt_limited)
        if mm.jnt_type[j] >= 2 and not mm.jnt_range[j, 0] - 1e-9 <= md.qpos[mm.jnt_qposadr[j]] <= mm.jnt_range[j, 1] + 1e-9
    ]
    return beyond, sum(c.dist - c.includemargin < -1e-3 for c in md.contact)
