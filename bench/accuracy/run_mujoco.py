"""MuJoCo: every integrator in steps; where it has constraints, by its defaults and as stiff as its steps allow."""


import mujoco
import numpy as np

from common import Failed, ladder, measured, steps_of

NAME, VERSION = "MuJoCo", mujoco.__version__
INTEGRATORS = {"Euler": mujoco.mjtIntegrator.mjINT_EULER, "RK4": mujoco.mjtIntegrator.mjINT_RK4,
               "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT, "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST}
if hasattr(mujoco.mjtIntegrator, "mjINT_DISCRETE"):  # from 4.0 on
    INTEGRATORS["discrete"] = mujoco.mjtIntegrator.mjINT_DISCRETE

FREE, BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)


class Scene:
    def __init__(self, problem, stiff):
        self.problem, self.stiff = problem, stiff
        self.model = m = mujoco.MjModel.from_xml_string(problem.mjcf)
        self.data = mujoco.MjData(m)
        m.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        if problem.restitution:  # springs without damping: the stiffest that the step resolves is set in measure
            m.opt.o_solimp[:] = (0.9999, 0.9999, 0.001, 0.5, 2)
        self.q, self.v = m.qpos0.copy(), np.zeros(m.nv)
        self.force = np.zeros(m.nv)
        for name, x in problem.q.items():
            self.q[m.joint(name).qposadr[0]] = x
        for values, out in ((problem.v, self.v), (problem.tau, self.force)):
            for name, x in values.items():
                at, x = m.joint(name).dofadr[0], np.atleast_1d(x)
                out[at:at + len(x)] = x
        self.bodies = np.array([m.body(body).id for body, _ in problem.markers])
        self.points = np.array([p for _, p in problem.markers], dtype=float)

    def set_step(self, integrator, dt, stiff):
        m = self.model
        m.opt.integrator, m.opt.timestep = INTEGRATORS[integrator], dt
        self.count = round(self.problem.duration / 10 / dt)
        if self.problem.restitution:
            k = 10 * (0.2 / dt if stiff else 0.05 / dt) ** 2 / 25  # a contact of 16 or 63 steps
            m.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_OVERRIDE
            m.opt.o_solref[:] = (-k / 10, 0)
        elif stiff and self.problem.kind != "smooth":
            m.opt.impratio, m.opt.noslip_iterations, m.opt.tolerance = 100, 20, 1e-14
            for ref, imp in ((m.geom_solref, m.geom_solimp), (m.eq_solref, m.eq_solimp)):
                ref[:], imp[:] = (2 * dt, 1), (0.9999, 0.9999, 0.001, 0.5, 2)

    def begin(self):
        m, d = self.model, self.data
        mujoco.mj_resetData(m, d)
        d.qpos[:], d.qvel[:], d.qfrc_applied[:] = self.q, self.v, self.force
        if self.problem.ctrl:
            d.ctrl[:] = list(self.problem.ctrl.values())

    def move(self, k):
        mujoco.mj_step(self.model, self.data, self.count)

    def look(self):
        d = self.data
        bad = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
        if not np.all(np.isfinite(d.qpos)) or any(d.warning[w].number for w in bad):
            raise Failed("unstable")
        mujoco.mj_kinematics(self.model, d)
        R = d.xmat[self.bodies].reshape(-1, 3, 3)
        return d.xpos[self.bodies] + np.einsum("kij,kj->ki", R, self.points)


def points(problem, reference):
    out = []
    for stiff in (False,) if problem.kind == "smooth" else (False, True):
        scene = Scene(problem, stiff)

        def measure(method, value):
            scene.set_step(method.split(",")[0], value, stiff)
            return measured(method, value, scene.begin, scene.move, scene.look, reference, problem)

        for integrator in INTEGRATORS:
            out += ladder(integrator + (", stiff" if stiff else ""), steps_of(problem), measure)
    return out


class Motion:
    """dy/dt of y = (qpos, qvel), for a reference by another integrator."""

    def __init__(self, problem):
        self.scene = Scene(problem, False)
        self.scene.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
        self.scene.begin()

    def start(self):
        return np.concatenate([self.scene.q, self.scene.v])

    def __call__(self, t, y):
        m, d = self.scene.model, self.scene.data
        d.qpos[:], d.qvel[:] = y[:m.nq], y[m.nq:]
        mujoco.mj_forward(m, d)
        dq = np.zeros(m.nq)
        for j in range(m.njnt):
            q, v, kind = m.jnt_qposadr[j], m.jnt_dofadr[j], int(m.jnt_type[j])
            if kind == FREE:
                dq[q:q + 3] = d.qvel[v:v + 3]
                q, v = q + 3, v + 3
            if kind in (FREE, BALL):
                w, (x, y_, z) = y[q], y[q + 1:q + 4]
                a, b, c = d.qvel[v:v + 3]
                dq[q:q + 4] = 0.5 * np.array([-x * a - y_ * b - z * c, w * a + y_ * c - z * b, w * b + z * a - x * c,
                                              w * c + x * b - y_ * a])
            else:
                dq[q] = d.qvel[v]
        return np.concatenate([dq, d.qacc])

    def places(self, y):
        m, d = self.scene.model, self.scene.data
        d.qpos[:] = y[:m.nq]
        return self.scene.look()


def confirmation(problem):
    """The places by scipy's DOP853 at its tightest, on MuJoCo's accelerations."""
    from scipy.integrate import solve_ivp

    motion = Motion(problem)
    done = solve_ivp(motion, (0, problem.duration), motion.start(), "DOP853", problem.times, rtol=2.3e-14, atol=1e-14)
    return np.array([motion.places(y) for y in done.y.T])


