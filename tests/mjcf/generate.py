#!/usr/bin/env python3
"""Write golden.json: what MuJoCo makes of models/*.xml. usage: generate.py (with the packages mujoco and numpy)

For each model: sizes, names and, at three states, inertia matrix, bias forces, positions of the bodies; masses of the bodies,
dampings and the like of the joints. Quantities are MuJoCo's, in its conventions: quaternions (w, x, y, z), a free joint's
velocity with the linear part in world axes.
"""
import json
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
MODELS = ["tree.xml", "meshes.xml", "whole.xml", "springs.xml"]


def body(m, i):
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, m.body_iquat[i])
    R = R.reshape(3, 3)
    return {"mass": m.body_mass[i], "com": list(m.body_ipos[i]), "inertia": (R @ np.diag(m.body_inertia[i]) @ R.T).tolist()}


def state(m, d, rng, moved):
    d.qpos[:] = m.qpos0
    if moved:
        mujoco.mj_integratePos(m, d.qpos, rng.normal(size=m.nv), 1.0)
    d.qvel[:] = rng.normal(size=m.nv)
    mujoco.mj_fwdPosition(m, d)
    mujoco.mj_fwdVelocity(m, d)
    M = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, d, M)
    return {"qpos": list(d.qpos), "qvel": list(d.qvel), "M": M.tolist(), "bias": list(d.qfrc_bias), "x": d.xpos[1:].tolist(),
            "R": d.xmat[1:].tolist()}


def model(path):
    m = mujoco.MjModel.from_xml_path(str(path))
    d = mujoco.MjData(m)
    rng = np.random.default_rng(7)
    return {
        "nq": m.nq, "nv": m.nv, "gravity": list(m.opt.gravity), "qpos0": list(m.qpos0),
        "bodies": {m.body(i).name: body(m, i) for i in range(1, m.nbody)},
        "joints": [{"name": m.joint(j).name, "type": int(m.jnt_type[j]), "qpos": int(m.jnt_qposadr[j]),
                    "dof": int(m.jnt_dofadr[j]), "range": list(m.jnt_range[j]) if m.jnt_limited[j] else None}
                    for j in range(m.njnt)],
        "damping": np.asarray(m.dof_damping).reshape(m.nv, -1)[:, 0].tolist(), "armature": list(m.dof_armature),
        "friction": list(m.dof_frictionloss), "stiffness": np.asarray(m.jnt_stiffness).reshape(m.njnt, -1)[:, 0].tolist(),
        "spring": list(m.qpos_spring), "keys": {m.key(k).name or f"key_{k}": list(m.key_qpos[k]) for k in range(m.nkey)},
        "sites": [m.site(s).name for s in range(m.nsite)],
        "states": [state(m, d, rng, k > 0) for k in range(3)],
    }


if __name__ == "__main__":
    golden = {"mujoco": mujoco.__version__, "models": {name: model(HERE / "models" / name) for name in MODELS}}
    (HERE / "golden.json").write_text(json.dumps(golden, indent=0) + "\n")
