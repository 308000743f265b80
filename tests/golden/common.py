"""What generate.py and check.py share: where the robots are, and how two figures are compared."""
import pathlib
import sys

import numpy as np

ILL_CONDITIONED = 1e8  # cond(M) from which on the 40 digits are stored and decide


def robots_folder(given=None):
    """The folder `robots` of the installed package example-robot-data: given, or found in this Python's packages."""
    if given:
        folders = [pathlib.Path(given)]
    else:
        inside = pathlib.Path("share") / "example-robot-data" / "robots"
        folders = [pathlib.Path(p) / "cmeel.prefix" / inside for p in sys.path]
        try:
            import example_robot_data
            folders += [p / inside for p in pathlib.Path(example_robot_data.__file__).resolve().parents]
        except ImportError:
            pass
        folders += [pathlib.Path(p) / inside for p in (sys.prefix, "/usr", "/usr/local", "/opt/openrobots")]
    for folder in folders:
        if folder.is_dir():
            return folder
    raise SystemExit("example-robot-data is not installed (pip install example-robot-data) and --robots names no folder")


# how a figure's rows and columns scale with the size of a joint's inertia (see scaled)
FORCES = {"nle", "g", "tau", "tau_fext", "static_torque", "dg_dq a", "dstatic_torque_dq a"}
ACCELERATIONS = {"ddq", "ddq_fext"}
FORCE_MATRICES = {"M", "coriolis", "dtau_dq", "dtau_dv"}
ACCELERATION_MATRICES = {"ddq_dq", "ddq_dv"}
MOMENTUM_ROWS = {"Jcom", "Ag", "dAg", "dh_dq", "dhdot_dq", "dhdot_dv"}


def scaled(name, x, diagonal):
    """The figure in units in which M has ones on its diagonal, so that a finger counts as much as the trunk: the
    norm of M itself would not notice a finger's row being wrong."""
    w = 1 / np.sqrt(diagonal)
    if name in FORCES:
        return x * w
    if name in ACCELERATIONS:
        return x / w
    if name in FORCE_MATRICES:
        return x * np.outer(w, w)
    if name == "Minv":
        return x / np.outer(w, w)
    if name in ACCELERATION_MATRICES:
        return x / w[:, None] * w
    if name in MOMENTUM_ROWS:
        return x * w
    return x


def error(x, y):
    """Norm-wise difference of x from y, relative to y; below a norm of 1e-3 absolute, for what should be zero."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    if x.shape != y.shape:
        return float("inf")
    difference = float(np.linalg.norm(x - y) / max(np.linalg.norm(y), 1e-3))
    return difference if np.isfinite(difference) else float("inf")
