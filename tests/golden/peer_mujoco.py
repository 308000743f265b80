"""MuJoCo's figures for one robot, converted to libdyn's order and conventions.

Where the conventions differ:
- URDF: MuJoCo reads no <mimic> (the full model is projected by G, as for Pinocchio), takes <dynamics> damping and
  friction into its passive forces (set to zero here), has no floating base (a free joint is added to the root link).
  Meshes are stripped with the visual and collision elements; a link without <inertial> stays without mass
  (inertiafromgeom off), inertias are not repaired (balanceinertia off), fixed links stay bodies (fusestatic off).
  MuJoCo refuses a file in which any link, fixed ones too, has an inertia that is not positive or violates A + B >= C.
- quaternion (w, x, y, z) for (x, y, z, w).
- free joint: qvel = [velocity of the origin in the world's axes; angular velocity in the body's], libdyn's
  v = [both in the body's axes]. With T = diag(R, 1), u = T v and u' = T a + [R (w x v); 0]: qacc's linear part is the
  classical acceleration of the origin, libdyn's a the spatial one. So
      M = T' M_mj T      tau = T' tau_mj      nle = T' (bias_mj + M_mj [R (w x v); 0])      a = T^-1 (qacc - [R (w x v); 0])
- MuJoCo keeps inertias as principal moments and a quaternion; older versions lose digits there (about 4e-9 for links whose
  inertia is not diagonal in the file). Version 4.0.0 does not: the agreement is 1e-13 or better, and 1e-10 is demanded.
- subtree_com of a body is in the world's frame; the whole robot's includes the mass of a fixed root link.
"""
import xml.etree.ElementTree as ET

import mujoco
import numpy as np


def load(path, floating):
    root = ET.parse(path).getroot()
    for link in root.findall("link"):
        for tag in link.findall("visual") + link.findall("collision"):
            link.remove(tag)
    for tag in root.findall("mujoco"):
        root.remove(tag)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false", balanceinertia="false",
                  inertiafromgeom="false")
    spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
    if floating:
        spec.worldbody.first_body().add_freejoint(name="root_joint")
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model = spec.compile()
    for passive in model.dof_damping, model.dof_frictionloss, model.dof_armature, model.jnt_stiffness:
        passive[:] = 0
    return model


class Peer:
    def __init__(self, path, robot):
        self.robot = robot
        self.floating = robot.joints[0].kind == "floating"
        self.model = load(path, self.floating)
        self.data = mujoco.MjData(self.model)
        self.G = np.zeros((self.model.nv, robot.nv))
        for joint in robot.joints:
            row, width = self.model.joint(joint.name).dofadr[0], max(joint.nv, 1)
            self.G[row:row + width, joint.idx_v:joint.idx_v + width] = joint.multiplier * np.eye(width)

    def place(self, q, v):
        m, d = self.model, self.data
        mujoco.mj_resetData(m, d)
        for joint in self.robot.joints:
            i = m.joint(joint.name).qposadr[0]
            if joint.kind == "floating":
                x = q[joint.idx_q:joint.idx_q + 7]
                d.qpos[i:i + 7] = [*x[:3], x[6], *x[3:6]]
            else:
                d.qpos[i] = joint.multiplier * q[joint.idx_q] + joint.offset
        T, drift = np.eye(m.nv), np.zeros(m.nv)
        if self.floating:
            i = m.joint("root_joint").dofadr[0]
            R = np.zeros(9)
            mujoco.mju_quat2Mat(R, np.array([q[6], *q[3:6]]) / np.linalg.norm(q[3:7]))
            T[i:i + 3, i:i + 3] = R.reshape(3, 3)
            drift[i:i + 3] = R.reshape(3, 3) @ np.cross(v[3:6], v[:3])
        T = T @ self.G
        d.qvel[:] = T @ v
        return T, drift

    def figures(self, q, v, a, tau, links, subtrees):
        m, d = self.model, self.data
        T, drift = self.place(q, v)
        d.qacc[:] = T @ a + drift
        mujoco.mj_inverse(m, d)
        inverse = T.T @ d.qfrc_inverse
        mujoco.mj_forward(m, d)
        M = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, d, M)
        out = {"M": T.T @ M @ T, "nle": T.T @ (d.qfrc_bias + M @ drift), "tau": inverse}
        if m.nv == self.robot.nv:  # MuJoCo's own forward dynamics
            d.qfrc_applied[:] = np.linalg.solve(T.T, tau)
            mujoco.mj_forward(m, d)
            out["ddq"] = np.linalg.solve(T, d.qacc - drift)
        else:
            out["ddq"] = np.linalg.solve(out["M"], tau - out["nle"])
        out["positions"] = {name: d.body(name).xpos.copy() for name in links}
        out["subtree_com"] = {j.name: d.subtree_com[m.body(j.child).id].copy() for j in subtrees}
        return out
