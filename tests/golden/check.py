"""Compares libdyn with the golden figures: python check.py [--robots DIR] [--only NAME ..] [--tolerance 1e-9]

Exit status 0 only when every figure agrees. Prints the worst error of each quantity over all robots, then the failures.
Everything that is said to the package `dyn` is in the class Libdyn.
"""
import argparse
import json
import pathlib
import sys

import numpy as np

from common import ILL_CONDITIONED, error, robots_folder, scaled

REFERENCES = ("LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED")
THROUGH_MINV = {"ddq", "ddq_fext", "Minv", "ddq_dq", "ddq_dv"}  # their tolerance grows with cond(M) beyond 1e8


class Libdyn:
    """One robot seen through the package dyn: one method a quantity, named as in the golden files."""

    def __init__(self, path, base):
        import libdyn as dyn
        self.model = dyn.load(str(path), base=base)
        self.data = self.model.data()

    # the model
    def nq(self):
        return self.model.nq

    def nv(self):
        return self.model.nv

    def total_mass(self):
        return self.model.total_mass

    def joint(self, name):
        """(idx_q, idx_v, nq, nv)"""
        info = self.model.joint(name)
        return info.idx_q, info.idx_v, info.nq, info.nv

    def joint_order(self):
        return [self.model.joint_name(i) for i in range(1, self.model.njoints)]

    def forces(self, fext):
        """{joint: 6} to 6 x njoints, the universe's column first."""
        out = np.zeros((6, self.model.njoints))
        for name, force in fext.items():
            out[:, self.model.joint_id(name)] = force
        return out

    # dynamics of the state s
    def M(self, s):
        return self.data.crba(s["q"])

    def nle(self, s):
        return self.data.compute_nle(s["q"], s["v"])

    def g(self, s):
        return self.data.gravity_torque(s["q"])

    def tau(self, s):
        return self.data.rnea(s["q"], s["v"], s["a"])

    def tau_fext(self, s):
        return self.data.rnea(s["q"], s["v"], s["a"], self.forces(s["fext"]))

    def static_torque(self, s):
        return self.data.compute_static_torque(s["q"], self.forces(s["fext"]))

    def ddq(self, s):
        return self.data.aba(s["q"], s["v"], s["tau"])

    def ddq_fext(self, s):
        return self.data.aba(s["q"], s["v"], s["tau"], self.forces(s["fext"]))

    def Minv(self, s):
        return self.data.minv(s["q"])

    def coriolis(self, s):
        return self.data.coriolis_matrix(s["q"], s["v"])

    def energy(self, s):
        """(kinetic, potential)"""
        return self.data.energy(s["q"], s["v"])

    # centre of mass and centroidal quantities
    def centers_of_mass(self, s):
        """(com, vcom, acom)"""
        com = self.data.compute_com(s["q"], s["v"], s["a"])
        return com, self.data.vcom.copy(), self.data.acom.copy()

    def Jcom(self, s):
        return self.data.jcom(s["q"])

    def subtree_com(self, s, joint):
        self.data.compute_com(s["q"], s["v"], s["a"])
        return self.data.subtree_com(joint)[0]

    def centroidal(self, s):
        """{"Ag", "dAg", "hg", "dhg", "Ig"}; Ig is the 3 x 3 inertia about the centre of mass, world axes"""
        values = self.data.centroidal(s["q"], s["v"], s["a"])
        return values._asdict() | {"Ig": values.Ig[3:, 3:]}

    def inertial_parameters(self):
        return self.model.inertial_parameters()

    def regressors(self, s):
        """{"regressor_times_tau": Y' tau, ...}: Y itself would be a large file"""
        q, v = s["q"], s["v"]
        return {"regressor_times_tau": self.data.joint_torque_regressor(q, v, s["a"]).T @ s["tau"],
                "kinetic_energy_regressor": self.data.compute_kinetic_energy_regressor(q, v),
                "potential_energy_regressor": self.data.compute_potential_energy_regressor(q)}

    def centroidal_derivatives(self, s):
        return self.data.centroidal_derivatives(s["q"], s["v"], s["a"])._asdict()

    def rest_derivatives(self, s):
        return {"dg_dq a": self.data.gravity_torque_derivatives(s["q"]) @ s["a"],
                "dstatic_torque_dq a": self.data.static_torque_derivatives(s["q"], self.forces(s["fext"])) @ s["a"],
                "dvcom_dq a": self.data.vcom_derivatives(s["q"], s["v"]).dvcom_dq @ s["a"]}

    # derivatives by tangent vectors
    def inverse_derivatives(self, s):
        """(dtau_dq, dtau_dv)"""
        return self.data.rnea_derivatives(s["q"], s["v"], s["a"])[:2]

    def forward_derivatives(self, s):
        """(ddq_dq, ddq_dv)"""
        return self.data.aba_derivatives(s["q"], s["v"], s["tau"])[:2]

    # frames: begin_frames once a state, then the queries
    def begin_frames(self, s):
        self.data.forward_kinematics(s["q"], s["v"], s["a"])

    def placement(self, frame):
        """(translation, rotation)"""
        placement = self.data.frame_placement(frame)
        return placement.translation, placement.rotation

    def velocity(self, frame, reference):
        return self.data.frame_velocity(frame, reference)

    def acceleration(self, frame, reference):
        return self.data.frame_acceleration(frame, reference)

    def classical_acceleration(self, frame, reference):
        return self.data.frame_classical_acceleration(frame, reference)

    def J(self, frame, reference):
        return self.data.frame_jacobian(frame, reference)

    def dJ(self, frame, reference):
        return self.data.frame_jacobian_time_variation(frame, reference)

    def frame_derivatives(self, s, frame, reference):
        v = self.data.frame_velocity_derivatives(frame, reference)
        a = self.data.frame_acceleration_derivatives(frame, reference)
        classical = self.data.frame_classical_acceleration_derivatives(frame, reference)
        H = self.data.frame_kinematic_hessian(frame, reference)
        return {"dv_dq a": v.dv_dq @ s["a"], "da_dq a": a.da_dq @ s["a"], "da_dv a": a.da_dv @ s["a"],
                "classical_dq a": classical.da_dq[:3] @ s["a"], "classical_dv a": classical.da_dv[:3] @ s["a"],
                "H a v": np.einsum("rjk,j,k->r", H, s["a"], s["v"])}

    # configuration space
    def neutral(self):
        return self.model.neutral()

    def integrate(self, q, v):
        return self.model.integrate(q, v)

    def difference(self, q0, q1):
        return self.model.difference(q0, q1)

    def interpolate(self, q0, q1, u):
        return self.model.interpolate(q0, q1, u)

    def distance(self, q0, q1):
        return self.model.distance(q0, q1)

    def integrate_jacobians(self, q, v):
        return self.model.integrate_jacobians(q, v)

    def difference_jacobians(self, q0, q1):
        return self.model.difference_jacobians(q0, q1)


class Table:
    """The worst error of each quantity, and the list of failures."""

    def __init__(self, tolerance):
        self.tolerance, self.rows, self.failures = tolerance, {}, []

    def figure(self, quantity, where, value, expected, ratio=1.0):
        """ratio: how much more than the tolerance is allowed here."""
        e = error(value, expected)
        row = self.rows.setdefault(quantity, [0, -1.0, "", False])
        row[0] += 1
        if e / ratio > row[1]:
            row[1], row[2] = e / ratio, where
        if e > self.tolerance * ratio:
            row[3] = True
            self.failures.append(f"{where}: {quantity} differs by {e:.1e} (allowed {self.tolerance * ratio:.0e})")

    def call(self, quantities, where, function, *args):
        """The function's result, or None when it fails: noted for each quantity that it should have given."""
        try:
            return function(*args)
        except Exception as problem:
            for quantity in quantities:
                self.rows.setdefault(quantity, [0, -1.0, "", False])[3] = True
                self.failures.append(f"{where}: {quantity}: {type(problem).__name__}: {problem}")
            return None

    def show(self):
        print(f"{'quantity':26} {'figures':>7} {'worst error':>11}  at")
        for quantity, (count, worst, where, failed) in self.rows.items():
            shown = f"{worst:11.1e}" if count else f"{'-':>11}"
            print(f"{quantity:26} {count:7} {shown}  {where}{'  FAILED' if failed else ''}")


def arrays(x):
    """JSON to numpy: a list of numbers or of rows becomes an array."""
    if isinstance(x, dict):
        return {key: arrays(value) for key, value in x.items()}
    if isinstance(x, list) and x and not isinstance(x[0], (dict, str)):
        return np.array(x, float)
    if isinstance(x, list):
        return [arrays(value) for value in x]
    return x


def same_sheet(golden, q, expected):
    """q with the sign of its quaternion and the turns of its continuous joints as in expected: the same configuration."""
    q = np.array(q, float)
    if q.shape != expected.shape:
        return q
    for joint in golden["joints"]:
        i = joint["idx_q"]
        if joint["type"] == "floating" and q[i + 3:i + 7] @ expected[i + 3:i + 7] < 0:
            q[i + 3:i + 7] *= -1
        if joint["type"] == "continuous" and "mimic" not in joint:
            q[i] += 2 * np.pi * np.round((expected[i] - q[i]) / (2 * np.pi))
    return q


def check_model(table, robot, golden):
    where = golden["name"]
    for quantity in "nq", "nv", "total_mass":
        value = table.call([quantity], where, getattr(robot, quantity))
        if value is not None:
            table.figure(quantity, where, value, golden[quantity])
    pi = table.call(["inertial_parameters"], where, robot.inertial_parameters)
    if pi is not None:
        table.figure("inertial_parameters", where, pi, golden["inertial_parameters"])
    names = [j["name"] for j in golden["joints"]]
    order = table.call(["joint order"], where, robot.joint_order)
    if order is not None:
        table.figure("joint order", where, 0.0 if order == names else 1.0, 0.0)
    for j in golden["joints"]:
        value = table.call(["joint indices"], f"{where}, {j['name']}", robot.joint, j["name"])
        if value is not None:
            table.figure("joint indices", f"{where}, {j['name']}", value, [j[x] for x in ("idx_q", "idx_v", "nq", "nv")])


def check_dynamics(table, robot, s, where):
    expected = s["expect"] | s.get("reference", {})  # where M is ill-conditioned, 40 digits decide
    diagonal = np.diag(expected["M"])
    ratio = max(1.0, expected["cond"] / ILL_CONDITIONED)

    def compare(quantity, value, golden=expected, prefix=""):
        if value is None or quantity not in golden:
            return
        allowed = ratio if quantity in THROUGH_MINV else 1.0
        if np.shape(value) != golden[quantity].shape:
            value = np.full(golden[quantity].shape, np.inf)
        table.figure(prefix + quantity, where, scaled(quantity, value, diagonal),
                     scaled(quantity, golden[quantity], diagonal), allowed)

    for quantity in ("M", "nle", "g", "tau", "tau_fext", "static_torque", "ddq", "ddq_fext", "Minv", "coriolis", "Jcom"):
        if quantity in expected:
            value = table.call([quantity], where, getattr(robot, quantity), s)
            compare(quantity, value)
            if quantity in s.get("mujoco", {}):
                compare(quantity, value, s["mujoco"], "MuJoCo ")

    groups = [(("com", "vcom", "acom"), robot.centers_of_mass)]
    if "dtau_dq" in expected:
        groups += [(("dtau_dq", "dtau_dv"), robot.inverse_derivatives), (("ddq_dq", "ddq_dv"), robot.forward_derivatives)]
    for quantities, function in groups:
        for quantity, value in zip(quantities, table.call(quantities, where, function, s) or ()):
            compare(quantity, value)
    centroidal = ("Ag", "dAg", "hg", "dhg", "Ig")
    values = table.call(centroidal, where, robot.centroidal, s)
    for quantity in centroidal if values is not None else ():
        compare(quantity, values[quantity])

    for group in "regressors", "centroidal_derivatives", "rest_derivatives":
        values = table.call(s.get(group, ()), where, getattr(robot, group), s)
        for quantity in s.get(group, ()) if values is not None else ():
            compare(quantity, values[quantity], s[group])

    energy = table.call(["kinetic", "potential", "mechanical"], where, robot.energy, s)
    if energy is not None:
        for quantity, value in ("kinetic", energy[0]), ("potential", energy[1]), ("mechanical", energy[0] + energy[1]):
            table.figure(quantity, where, value, expected["energy"][quantity])
    for joint, com in expected["subtree_com"].items():
        value = table.call(["subtree_com"], f"{where}, {joint}", robot.subtree_com, s, joint)
        if value is not None:
            table.figure("subtree_com", f"{where}, {joint}", value, com)


def check_frames(table, robot, s, where):
    if table.call(["frames"], where, lambda: (robot.begin_frames(s), True)) is None:
        return
    for frame, placement in s["expect"]["placements"].items():
        at = f"{where}, {frame}"
        value = table.call(["translation", "rotation"], at, robot.placement, frame)
        if value is not None:
            table.figure("translation", at, value[0], placement["translation"])
            table.figure("rotation", at, value[1], placement["rotation"])
            if frame in s.get("mujoco", {}).get("positions", {}):
                table.figure("MuJoCo position", at, value[0], s["mujoco"]["positions"][frame])
        for reference, figures in s["expect"]["frames"][frame].items():
            for quantity, expected in figures.items():
                name = f"{quantity.replace('_acceleration', '')} {reference}"
                value = table.call([name], at, getattr(robot, quantity), frame, reference)
                if value is not None:
                    table.figure(name, at, value, expected)
        for reference, figures in s.get("frame_derivatives", {}).get(frame, {}).items():
            values = table.call(figures, at, robot.frame_derivatives, s, frame, reference)
            for quantity, expected in figures.items() if values is not None else ():
                table.figure(f"{quantity} {reference}", at, values[quantity], expected)


def check_configuration(table, robot, golden, where):
    c = golden["configuration"]
    calls = {"neutral": (robot.neutral,), "integrate": (robot.integrate, c["q0"], c["v"]),
             "interpolate": (robot.interpolate, c["q0"], c["q1"], c["u"]),
             "difference": (robot.difference, c["q0"], c["q1"]), "distance": (robot.distance, c["q0"], c["q1"])}
    for quantity, (function, *args) in calls.items():
        value = table.call([quantity], where, function, *args)
        if value is not None:
            if quantity in ("neutral", "integrate", "interpolate"):
                value = same_sheet(golden, value, c[quantity])
            table.figure(quantity, where, value, c[quantity])
    jacobians = {"dIntegrate": (robot.integrate_jacobians, "v"), "dDifference": (robot.difference_jacobians, "q1")}
    for name, (function, second) in jacobians.items():
        quantities = [f"{name}_arg0", f"{name}_arg1"]
        for quantity, value in zip(quantities, table.call(quantities, where, function, c["q0"], c[second]) or ()):
            table.figure(quantity, where, value, c[quantity])


def check_robot(table, golden, folder):
    name = golden["name"]
    try:
        robot = Libdyn(folder / golden["urdf"], golden["base"])
    except Exception as problem:
        named = [link for link in golden["impossible_inertias"] if link in str(problem)]
        if named:
            print(f"{name}: refused for an impossible inertia, as it may be: {problem}")
        else:
            table.failures.append(f"{name}: does not load: {type(problem).__name__}: {problem}")
        return
    check_model(table, robot, golden)
    check_configuration(table, robot, golden, name)
    for i, s in enumerate(golden["states"]):
        check_dynamics(table, robot, s, f"{name}, state {i}")
        check_frames(table, robot, s, f"{name}, state {i}")


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description="compare libdyn with the golden figures")
    parser.add_argument("--robots", help="the robots folder of example-robot-data")
    parser.add_argument("--golden", type=pathlib.Path, default=here, help="the folder of the JSON files")
    parser.add_argument("--only", nargs="*", help="these robots only")
    parser.add_argument("--tolerance", type=float, default=1e-9)
    parser.add_argument("--failures", type=int, default=40, help="how many failures to list")
    options = parser.parse_args()
    folder = robots_folder(options.robots)
    files = sorted(f for f in options.golden.glob("*.json") if not options.only or f.stem in options.only)
    if not files or options.only and len(files) < len(set(options.only)):
        raise SystemExit(f"no golden files of these robots in {options.golden}")
    try:
        import libdyn as dyn  # noqa: F401  said once, not once a robot
    except ImportError as problem:
        raise SystemExit(f"the package dyn cannot be imported ({problem}); set PYTHONPATH to capi/python")

    table = Table(options.tolerance)
    for file in files:
        golden = json.loads(file.read_text())
        check_robot(table, arrays(golden) | {"joints": golden["joints"], "name": golden["name"]}, folder)
    table.show()
    for failure in table.failures[:options.failures]:
        print("FAILED", failure, file=sys.stderr)
    if table.failures:
        print(f"{len(table.failures)} failures in {len(files)} robots", file=sys.stderr)
        return 1
    print(f"all figures of {len(files)} robots agree within {options.tolerance:g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
