"""Regenerates the golden figures: python generate.py [--out DIR] [--robots DIR] [--only NAME ..]

Needs pin, mujoco, example-robot-data, numpy and mpmath. One JSON file a robot: what the robot is (file, base, joints in
libdyn's order), three random states, and what Pinocchio and MuJoCo say at each, in libdyn's order and conventions. How
conventions differ is written at the top of peer_pinocchio.py and peer_mujoco.py. No figure is stored before it
has passed the identities below and, as far as it goes, the comparison with 40 digits (reference.py).
"""
import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"  # the same sums in the same order

import argparse
import importlib.metadata
import json
import pathlib
import zlib

import numpy as np

import peer_mujoco
import peer_pinocchio
import reference
from common import ILL_CONDITIONED, error, robots_folder, scaled

# name, file, base, why
ROBOTS = [
    ("double_pendulum", "double_pendulum_description/urdf/double_pendulum_continuous.urdf", "fixed", "continuous joints"),
    ("ur5", "ur_description/urdf/ur5_robot.urdf", "fixed", "arm"),
    ("so101", "so_arm_description/urdf/so101.urdf", "fixed", "small arm, arbitrary frames"),
    ("panda", "panda_description/urdf/panda.urdf", "fixed", "arm, mimic finger"),
    ("kinova", "kinova_description/robots/kinova.urdf", "fixed", "arm, continuous joints"),
    ("allegro", "allegro_hand_description/urdf/allegro_right_hand.urdf", "fixed", "hand; inertias against the triangle rule"),
    ("baxter", "baxter_description/urdf/baxter.urdf", "fixed", "two arms, mimic with multiplier -1"),
    ("pr2", "pr2_description/urdf/pr2.urdf", "fixed", "ten mimic joints, continuous, prismatic"),
    ("iris", "iris_description/robots/iris.urdf", "floating", "drone"),
    ("a1", "a1_description/urdf/a1.urdf", "floating", "quadruped, file order is not alphabetical"),
    ("go2", "go2_description/urdf/go2.urdf", "floating", "quadruped"),
    ("anymal_c", "anymal_c_simple_description/urdf/anymal.urdf", "floating", "quadruped, root link without mass"),
    ("simple_humanoid", "simple_humanoid_description/urdf/simple_humanoid.urdf", "floating", "humanoid"),
    ("icub", "icub_description/robots/icub.urdf", "floating", "humanoid, cond(M) > 1e8"),
    ("g1_hands", "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", "floating", "humanoid with hands"),
    ("talos", "talos_data/robots/talos_full_v2.urdf", "floating", "humanoid, followers before their leaders"),
    ("tiago", "tiago_description/robots/tiago_no_hand.urdf", "floating", "mobile base, continuous wheels"),
    ("tiago_pro", "tiago_pro_description/robots/tiago_pro.urdf", "floating", "mobile base, mimic and continuous joints"),
]
STATES = 3
SMALL = 12             # robots up to this nv keep their large matrices in every state, others in the first


class Identities:
    """Collects what was checked; a wrong conversion stops the script."""

    def __init__(self):
        self.count, self.failures = 0, []

    def __call__(self, what, x, y, tolerance=1e-11):
        self.count += 1
        if not error(x, y) <= tolerance:
            self.failures.append(f"{what}: {error(x, y):.1e} > {tolerance:.0e}")

    def done(self, robot):
        if self.failures:
            raise SystemExit(f"{robot}: identities fail:\n  " + "\n  ".join(self.failures))


def choose_frames(robot):
    """Six frames spread over the robot: links and joints, a fixed joint and a follower where there is one."""
    ambiguous = set(robot.link_names) & {j.name for j in robot.all_joints}
    joints = [j for j in robot.joints if j.kind != "floating"]
    fixed = [j for j in robot.all_joints if j.kind == "fixed" and not (j.p == 0).all()]
    followers = [j for j in joints if j.leader]
    n = len(joints)
    wanted = [("link", robot.root), ("joint", joints[n // 3].name), ("link", joints[n // 2].child),
              ("joint", joints[-1].name), ("link", robot.link_names[-1])]
    wanted += [("joint", fixed[len(fixed) // 2].name)] if fixed else []
    wanted += [("link", followers[len(followers) // 2].child)] if followers else []
    return [{"name": name, "type": kind} for kind, name in dict.fromkeys(wanted) if name not in ambiguous][-6:]


def choose_subtrees(robot):
    joints = [j for j in robot.joints if robot_mass(robot, j) > 0]
    return [joints[i] for i in sorted({0, len(joints) // 2, len(joints) - 1})]


def robot_mass(robot, joint):
    """Mass of the link a joint moves (without what is fixed to it)."""
    return float(robot.inertia[joint.child][0])


def impossible(inertia):
    """No mass distribution has it: negative mass or moment, or a moment larger than the sum of the other two."""
    mass, _, I = inertia
    moments = np.linalg.eigvalsh(reference.double(I))
    slack = 1e-9 * np.abs(moments).max()
    return bool(mass < 0 or moments[0] < -slack or moments[0] + moments[1] < moments[2] - slack)


def random_q(robot, rng):
    q = np.zeros(robot.nq)
    for joint in robot.joints:
        if joint.kind == "floating":
            quaternion = rng.normal(size=4)
            q[:7] = [*rng.uniform(-1, 1, 3), *quaternion / np.linalg.norm(quaternion)]
        elif joint.kind == "continuous":
            q[joint.idx_q] = rng.uniform(-5, 5)  # more than a turn, so that wrapping shows
        elif not joint.leader:
            reach = 1 if joint.kind == "prismatic" else np.pi
            q[joint.idx_q] = rng.uniform(max(joint.lower, -reach), min(joint.upper, reach))
    return q


def random_state(robot, peer, rng):
    q = random_q(robot, rng)
    v, a = rng.uniform(-2, 2, robot.nv), rng.uniform(-5, 5, robot.nv)
    M = peer.dynamics(q, 0 * v, 0 * a, 0 * a, {})["M"]
    tau = np.diag(M) * rng.uniform(-10, 10, robot.nv)  # so that every joint's acceleration is of the same order
    fext = {j.name: robot_mass(robot, j) * rng.uniform(-5, 5, 6) for j in robot.joints}
    return {"q": q, "v": v, "a": a, "tau": tau, "fext": fext}


def check_dynamics(check, s, e):
    """Identities between the figures e of the state s that hold to rounding."""
    M, v, a, diagonal = e["M"], s["v"], s["a"], np.diag(e["M"])
    loss = max(1e-11, 1e-15 * e["cond"])

    def forces(what, x, y, tolerance=1e-11):
        check(what, scaled("tau", x, diagonal), scaled("tau", y, diagonal), tolerance)

    check("M symmetric", M, M.T, 1e-15)
    forces("M a + nle = tau", M @ a + e["nle"], e["tau"])
    forces("C v + g = nle", e["coriolis"] @ v + e["g"], e["nle"])
    forces("M ddq + nle = tau", M @ e["ddq"] + e["nle"], s["tau"])
    forces("M (ddq_fext - ddq) = tau - tau_fext", M @ (e["ddq_fext"] - e["ddq"]), e["tau"] - e["tau_fext"], 1e-9)
    forces("tau_fext - tau = static torque - g", e["tau_fext"] - e["tau"], e["static_torque"] - e["g"], 1e-10)
    check("M Minv = 1", scaled("M", M, diagonal) @ scaled("Minv", e["Minv"], diagonal), np.eye(len(M)), loss)


def check_motion(check, s, e, info, peer):
    v, a, mass = s["v"], s["a"], info["total_mass"]
    check("v' M v / 2 = kinetic", v @ e["M"] @ v / 2, e["energy"]["kinetic"])
    check("-m g com = potential", 9.81 * mass * e["com"][2], e["energy"]["potential"])
    check("kinetic + potential", e["energy"]["kinetic"] + e["energy"]["potential"], e["energy"]["mechanical"])
    check("Jcom v = vcom", e["Jcom"] @ v, e["vcom"])
    check("m Jcom = Ag linear", mass * e["Jcom"], e["Ag"][:3])
    check("Ag v = hg", e["Ag"] @ v, e["hg"])
    check("Ag a + dAg v = dhg", e["Ag"] @ a + e["dAg"] @ v, e["dhg"])
    check("m acom = dhg linear", mass * e["acom"], e["dhg"][:3])
    for frame in info["frames"]:
        for name, entry in e["frames"][frame["name"]].items():
            if "J" not in entry:
                continue
            what = f"{frame['name']} {name}"
            check(f"{what}: J v = velocity", entry["J"] @ v, entry["velocity"])
            rate = "classical_acceleration" if name == "LOCAL_WORLD_ALIGNED" else "acceleration"
            check(f"{what}: J a + dJ v = {rate}", entry["J"] @ a + entry["dJ"] @ v, entry[rate])
            h, ref = 1e-5, peer_pinocchio.REFERENCES[name]
            ahead, behind = (peer.jacobian(peer.integrate(s["q"], t * v), frame, ref) for t in (h, -h))
            check(f"{what}: dJ is the time derivative of J", (ahead - behind) / (2 * h), entry["dJ"], 1e-7)


def check_derivatives(check, s, entry, info, peer):
    """Products with a against central differences along a."""
    h, q, v, a = 1e-5, s["q"], s["v"], s["a"]
    moves = {"q": lambda t: peer.moved(peer.integrate(q, t * a), v, a, info["frames"]),
             "v": lambda t: peer.moved(q, v + t * a, a, info["frames"])}
    ends = {by: (move(h), move(-h)) for by, move in moves.items()}
    for frame, references in entry["frame_derivatives"].items():
        for name, figures in references.items():
            rates = {by: [(x - y) / (2 * h) for x, y in zip(*(end[frame][name] for end in ends[by]))] for by in ends}
            expected = {"dv_dq a": rates["q"][0], "da_dq a": rates["q"][1], "da_dv a": rates["v"][1],
                        "classical_dq a": rates["q"][2][:3], "classical_dv a": rates["v"][2][:3]}
            for what in figures.keys() & expected.keys():
                check(f"{frame} {name}: {what}", expected[what], figures[what], 1e-6)
            along_v = [peer.moved(peer.integrate(q, t * v), v, a, info["frames"])[frame][name][3] @ a for t in (h, -h)]
            check(f"{frame} {name}: H a v", (along_v[0] - along_v[1]) / (2 * h), figures["H a v"], 1e-6)
    vcom = [peer.mass_and_energy(peer.integrate(q, t * a), v, a, [])["vcom"] for t in (h, -h)]
    check("dvcom_dq a", (vcom[0] - vcom[1]) / (2 * h), entry["rest_derivatives"]["dvcom_dq a"], 1e-6)


def check_configuration(check, c, peer):
    check("difference(q0, integrate(q0, v)) = v", *wrapped(peer, peer.difference(c["q0"], c["integrate"]), c["v"]))
    difference = peer.difference(c["q0"], c["q1"])
    check("integrate(q0, difference) = q1", peer.difference(peer.integrate(c["q0"], difference), c["q1"]), 0 * c["v"])
    check("conversion there and back", peer.difference(peer.from_pin(peer.to_pin(c["q0"])), c["q0"]), 0 * c["v"])
    h, n = 1e-6, len(c["v"])
    ends = {"0": lambda d: (peer.integrate(c["q0"], d), c["q1"]), "1": lambda d: (c["q0"], peer.integrate(c["q1"], d))}
    for name, move in ends.items():
        D = [(peer.difference(*move(h * e)) - peer.difference(*move(-h * e))) / (2 * h) for e in np.eye(n)]
        check(f"dDifference_arg{name}", np.array(D).T, c[f"dDifference_arg{name}"], 1e-7)
    moves = {"0": lambda d: peer.integrate(peer.integrate(c["q0"], d), c["v"]),
             "1": lambda d: peer.integrate(c["q0"], c["v"] + d)}
    for name, move in moves.items():
        D = [peer.difference(move(-h * e), move(h * e)) / (2 * h) for e in np.eye(n)]
        check(f"dIntegrate_arg{name}", np.array(D).T, c[f"dIntegrate_arg{name}"], 1e-7)


def wrapped(peer, x, y):
    """Two tangent vectors, the differences of continuous joints modulo a turn."""
    x = x.copy()
    for joint in peer.robot.joints:
        if joint.kind == "continuous":
            x[joint.idx_v] += 2 * np.pi * np.round((y[joint.idx_v] - x[joint.idx_v]) / (2 * np.pi))
    return x, y


def scaled_errors(figures, exact, diagonal):
    return {name: error(scaled(name, figures[name], diagonal), scaled(name, y, diagonal)) for name, y in exact.items()}


def against_reference(check, robot, info, s, e):
    """The 40 digits: every figure they reach is compared; returns the errors and, for an ill-conditioned M, the figures."""
    M, tau = robot.dynamics(s["q"], s["v"], s["a"])
    _, tau_fext = robot.dynamics(s["q"], s["v"], s["a"], s["fext"])
    _, nle = robot.dynamics(s["q"], s["v"], 0 * s["a"])
    Minv = reference.inverse(M)
    ddq = reference.double(Minv.dot(reference.exact(s["tau"]) - nle))
    ddq_fext = reference.double(Minv.dot(reference.exact(s["tau"]) - (tau_fext - M.dot(reference.exact(s["a"])))))
    exact = {"M": reference.double(M), "tau": reference.double(tau), "tau_fext": reference.double(tau_fext),
             "nle": reference.double(nle), "ddq": ddq, "ddq_fext": ddq_fext, "Minv": reference.double(Minv)}
    errors = scaled_errors(e, exact, np.diag(e["M"]))
    for name in exact:
        through_inverse = name in ("ddq", "ddq_fext", "Minv")
        check(f"40 digits: {name}", errors[name], 0, 1e3 * max(1e-12, 1e-16 * e["cond"] if through_inverse else 0))
    solved = {"ddq": np.linalg.solve(e["M"], s["tau"] - e["nle"])}
    errors["ddq_by_solving_with_M"] = scaled_errors(solved, {"ddq": ddq}, np.diag(e["M"]))["ddq"]

    state = robot.kinematics(*(reference.exact(s[x]) for x in ("q", "v", "a")))
    child = {j.name: j.child for j in robot.all_joints}
    for frame in info["frames"]:
        R, p, Jv, Jw, w, dw, ddp = state[child.get(frame["name"], frame["name"])]
        placement, motion = e["placements"][frame["name"]], e["frames"][frame["name"]]["LOCAL_WORLD_ALIGNED"]
        v = reference.exact(s["v"])
        for what, x, y in (("rotation", placement["rotation"], R), ("translation", placement["translation"], p),
                           ("velocity", motion["velocity"], np.concatenate([Jv.dot(v), w])),
                           ("classical", motion["classical_acceleration"], np.concatenate([ddp, dw])),
                           ("J", motion.get("J", reference.double(np.vstack([Jv, Jw]))), np.vstack([Jv, Jw]))):
            check(f"40 digits: {frame['name']} {what}", x, reference.double(y), 1e-12)
    stored = {name: exact[name] for name in ("ddq", "ddq_fext", "Minv")} if e["cond"] > ILL_CONDITIONED else None
    return errors, stored


def against_mujoco(check, mujoco, info, s, e, subtrees):
    figures = mujoco.figures(s["q"], s["v"], s["a"], s["tau"], [f["name"] for f in info["frames"] if f["type"] == "link"],
                             subtrees)
    errors = scaled_errors(figures, {name: e[name] for name in ("M", "nle", "tau", "ddq")}, np.diag(e["M"]))
    errors["positions"] = max(error(p, e["placements"][name]["translation"]) for name, p in figures["positions"].items())
    errors["subtree_com"] = max(error(p, e["subtree_com"][name]) for name, p in figures["subtree_com"].items())
    for name, value in errors.items():
        check(f"MuJoCo: {name}", value, 0, 1e-10)
    return figures, errors


def against_pinocchio_mimic(check, mimic, s, e, frame):
    """Pinocchio's own reduction, for what it supports."""
    m, d = mimic.model, mimic.data
    pin, G = peer_pinocchio.pin, mimic.G
    Q, V, A = mimic.to_pin(s["q"]), G @ s["v"], G @ s["a"]
    figures = {"M": G.T @ peer_pinocchio.symmetric(pin.crba(m, d, Q)) @ G, "tau": G.T @ pin.rnea(m, d, Q, V, A),
               "tau_fext": G.T @ pin.rnea(m, d, Q, V, A, mimic.forces(s["fext"])),
               "nle": G.T @ pin.nonLinearEffects(m, d, Q, V), "g": G.T @ pin.computeGeneralizedGravity(m, d, Q)}
    errors = scaled_errors(figures, {name: e[name] for name in figures}, np.diag(e["M"]))
    J = mimic.jacobian(s["q"], frame, pin.LOCAL)
    errors["J"] = error(J, e["frames"][frame["name"]]["LOCAL"]["J"])
    for name, value in errors.items():
        check(f"Pinocchio's own mimic: {name}", value, 0, 1e-9)
    return errors


def one_robot(name, file, base, why, folder):
    path = folder / file
    robot = reference.Robot(path, base == "floating")
    peer = peer_pinocchio.Peer(path, robot)
    check = Identities()
    rng = np.random.default_rng([2026, zlib.crc32(name.encode())])
    info = {"name": name, "urdf": file, "base": base, "why": why, "nq": robot.nq, "nv": robot.nv,
            "gravity": [0, 0, -9.81], "total_mass": peer_pinocchio.pin.computeTotalMass(peer.model),
            "fixed_base_mass": peer.model.inertias[0].mass,
            "joints": [{"name": j.name, "type": j.kind, "idx_q": j.idx_q, "idx_v": j.idx_v, "nq": j.nq, "nv": j.nv}
                       | ({"mimic": {"joint": j.leader, "multiplier": j.multiplier, "offset": j.offset}} if j.leader else {})
                       for j in robot.joints],
            "impossible_inertias": [name for name, inertia in robot.inertia.items() if impossible(inertia)],
            "frames": choose_frames(robot), "subtrees": [j.name for j in choose_subtrees(robot)]}
    pi = info["inertial_parameters"] = peer.inertial_parameters()
    check("total mass", info["total_mass"] + info["fixed_base_mass"], float(sum(x[0] for x in robot.inertia.values())))
    try:
        mujoco, info["mujoco"] = peer_mujoco.Peer(path, robot), "loaded"
    except ValueError as refusal:
        mujoco, info["mujoco"] = None, "refused: " + " ".join(str(refusal).split())
    mimic = None
    if any(j.leader for j in robot.joints):
        try:
            mimic, info["pinocchio_mimic"] = peer_pinocchio.Peer(path, robot, mimic=True), "loaded"
        except ValueError as refusal:
            info["pinocchio_mimic"] = f"refused: {refusal}"

    states, worst = [], {}
    subtrees = choose_subtrees(robot)
    for i in range(STATES):
        s = random_state(robot, peer, rng)
        q, v, a, tau = s["q"], s["v"], s["a"], s["tau"]
        large = i == 0 or robot.nv <= SMALL
        e = peer.dynamics(q, v, a, tau, s["fext"])
        e["cond"] = np.linalg.cond(e["M"])
        e |= peer.mass_and_energy(q, v, a, subtrees) | peer.frames(q, v, a, info["frames"], jacobians=large)
        check_dynamics(check, s, e)
        check_motion(check, s, e, info, peer)
        entry, agreement = dict(s), {}
        agreement["reference"], stored = against_reference(check, robot, info, s, e)
        if mujoco:
            entry["mujoco"], agreement["mujoco"] = against_mujoco(check, mujoco, info, s, e, subtrees)
        if mimic and large:
            agreement["pinocchio_mimic"] = against_pinocchio_mimic(check, mimic, s, e, info["frames"][-1])
        for peer_name, errors in agreement.items():
            for quantity, value in errors.items():
                worst.setdefault(peer_name, {}).setdefault(quantity, 0.0)
                worst[peer_name][quantity] = max(worst[peer_name][quantity], value)
        if large:
            e |= peer.derivatives(q, v, a, tau)
        else:
            for quantity in ("Minv", "coriolis", "Jcom", "Ag", "dAg"):
                del e[quantity]
            entry.get("mujoco", {}).pop("M", None)
            stored = stored and {k: x for k, x in stored.items() if k != "Minv"}
        Y, kinetic, potential = peer.regressors(q, v, a)
        for what, x, y in (("tau", Y @ pi, e["tau"]), ("kinetic", kinetic @ pi, e["energy"]["kinetic"]),
                           ("potential", potential @ pi, e["energy"]["potential"])):
            check(f"regressor of {what}", x, y)
        entry["regressors"] = {"regressor_times_tau": Y.T @ tau, "kinetic_energy_regressor": kinetic,
                               "potential_energy_regressor": potential}
        if large:
            entry["centroidal_derivatives"] = peer.centroidal_derivatives(q, v, a)
            entry["rest_derivatives"] = peer.rest_derivatives(q, v, a, s["fext"])
            entry["frame_derivatives"] = peer.frame_derivatives(q, v, a, info["frames"])
            check_derivatives(check, s, entry, info, peer)
        entry["expect"] = e
        if stored:
            entry["reference"] = stored
        states.append(entry)

    q0, q1, v = random_q(robot, rng), random_q(robot, rng), rng.uniform(-1, 1, robot.nv)
    configuration = peer.configuration(q0, q1, v, 0.3)
    check_configuration(check, configuration, peer)
    info["agreement"] = worst
    check.done(name)
    return info | {"configuration": configuration, "states": states}, check.count, states


def plain(x):
    """Only lists, dicts and numbers; integers where a double is one, which is shorter."""
    if isinstance(x, dict):
        return {key: plain(value) for key, value in x.items()}
    if isinstance(x, (list, tuple, np.ndarray)):
        return [plain(value) for value in x]
    if isinstance(x, (float, np.floating)):
        return int(x) if x == int(x) and abs(x) < 1e15 else float(x)
    return x


def write(path, content):
    """One line for a key, so that a difference is readable."""
    compact = dict(separators=(",", ":"), allow_nan=False)
    lines = []
    for key, value in plain(content).items():
        if key == "states":
            value = [",\n".join(f" {json.dumps(k)}:{json.dumps(x, **compact)}" for k, x in state.items()) for state in value]
            lines.append('"states":[\n{\n' + "\n},{\n".join(value) + "\n}]")
        else:
            lines.append(f"{json.dumps(key)}:{json.dumps(value, **compact)}")
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description="regenerate the golden figures")
    parser.add_argument("--out", type=pathlib.Path, default=here)
    parser.add_argument("--robots", help="the robots folder of example-robot-data")
    parser.add_argument("--only", nargs="*", help="these robots only")
    options = parser.parse_args()
    folder = robots_folder(options.robots)
    packages = {x: importlib.metadata.version(x) for x in ("pin", "mujoco", "example-robot-data", "mpmath", "numpy")}
    options.out.mkdir(parents=True, exist_ok=True)

    print(f"{'robot':16} {'base':8} {'nv':>3} {'cond(M)':>8} {'KiB':>5} {'checks':>6} | errors against 40 digits:"
          f" {'M':>7} {'tau':>7} {'ddq':>7} {'Minv':>7} | MuJoCo: {'M':>7} {'tau':>7} {'ddq':>7}")
    for name, file, base, why in ROBOTS:
        if options.only and name not in options.only:
            continue
        content, checks, states = one_robot(name, file, base, why, folder)
        content = {"versions": packages} | content
        target = options.out / f"{name}.json"
        write(target, content)
        r, m = content["agreement"]["reference"], content["agreement"].get("mujoco")
        print(f"{name:16} {base:8} {content['nv']:3} {max(s['expect']['cond'] for s in states):8.1e}"
              f" {target.stat().st_size // 1024:5} {checks:6} |" + " " * 26
              + " ".join(f"{r[x]:7.1e}" for x in ("M", "tau", "ddq", "Minv")) + " |         "
              + (" ".join(f"{m[x]:7.1e}" for x in ("M", "tau", "ddq")) if m else content["mujoco"]))
        if "pinocchio_mimic" in content:
            own = content["agreement"].get("pinocchio_mimic")
            print("   Pinocchio's own mimic:", {k: f"{x:.1e}" for k, x in own.items()} if own else content["pinocchio_mimic"])
        if any("reference" in s for s in states):
            print(f"   cond(M) > 1e8, stored 40 digits: ABA's ddq is off by {r['ddq']:.1e}, solving with M by"
                  f" {r['ddq_by_solving_with_M']:.1e}")


if __name__ == "__main__":
    main()
