"""A gripper holds a box by friction: how hard it must squeeze, in closed form and in simulation.

    python grasp.py

One joint drives seven others (mimic), so one torque squeezes from both sides. At rest the fingers push with n each, and friction carries the weight of the
box as long as m g <= 2 mu n. The work of the driving torque says which torque that is: tau = g(q) - sum J' f, with f what the box does to each finger, and
Jacobians by the driving joint alone, since the followers are no coordinates of their own.
"""

from pathlib import Path

import numpy as np

import libdyn as dyn

GRIPPER = Path(__file__).resolve().parents[3] / "models" / "robots" / "gripper.urdf"
MU, MASS, SIZE = 0.5, 0.2, np.array([0.02, 0.03, 0.03])  # -, kg, m
FINGERS = {"left_pad": (1, -0.004, 0.0), "right_finger": (-1, 0.006,
                                                          0.02)}  # side, and where the face is in the link: y, z of its middle, m


def scene():
    """The gripper, fingers up, and a box between its pads, which are all that touches."""
    b = dyn.Builder.from_model(dyn.load(GRIPPER, base="fixed"))
    inertia = np.diag(MASS / 12 * (np.sum(SIZE**2) - SIZE**2))
    b.add_joint("box_joint", "free_flyer").add_body("box", "box_joint", MASS, inertia=inertia)
    b.add_shape("box", "box", SIZE, name="box")
    return b.finish()


def data_of(model):
    """Without friction in joints, and with contact between box and fingers alone."""
    data = model.data()
    data.set_effects(())
    for k, pair in enumerate(model.pairs):
        names = {model.frame_name(model.shape(shape).frame) for shape in (pair.shape_a, pair.shape_b)}
        data.set_pair(k, "box" in names and bool(names & FINGERS.keys()))
    data.set_shape_material(None, dyn.Material(friction=MU))
    return data


def faces(model, data, q):
    """Middles of the two faces that squeeze."""
    data.forward_kinematics(q)
    return [data.frame_placement(link).translation + (0, y, z) for link, (_, y, z) in FINGERS.items()]


def closed(model, data):
    """q at which both faces touch the box, which lies at their height."""
    knuckle, box = model.joint("left_knuckle_joint").idx_q, model.joint("box_joint").idx_q
    low, high, q = 0.0, 0.8, model.neutral()
    for _ in range(60):
        q[knuckle] = (low + high) / 2
        left, right = faces(model, data, q)
        low, high = (q[knuckle], high) if left[1] - right[1] > SIZE[1] else (low, q[knuckle])
    q[box : box + 3] = (left + right) / 2
    return q


def least_torque(model, data, q):
    """Torque at which friction just carries the box."""
    knuckle = model.joint("left_knuckle_joint").idx_v
    data.forward_kinematics(q)
    n, weight = MASS * 9.81 / (2 * MU), MASS * 9.81
    tau = data.gravity_torque(q)[knuckle]
    for link, (side, _, _) in FINGERS.items():
        J = data.frame_jacobian(link, "local_world_aligned")[:3, knuckle]  # the links do not turn: all their points move alike
        tau -= J @ [0, side * n, -weight / 2]
    return tau


def hold(model, q, torque, seconds=0.5):
    """How far the box sinks, and the contact forces on it at the end."""
    data = data_of(model)
    data.set_step_options("semi_implicit_euler", 1e-4, tolerance=1e-10)
    tau = np.zeros(model.nv)
    tau[model.joint("left_knuckle_joint").idx_v] = torque
    data.set_state(q, np.zeros(model.nv), tau=tau)
    data.advance(seconds)
    box = model.frame_id("box")
    forces = [c.force_on_b if model.shape(c.contact.shape_b).frame == box else -c.force_on_b for c in data.step_contacts()]
    z = model.joint("box_joint").idx_q + 2
    return q[z] - data.q[z], np.array(forces).reshape(-1, 3)


def main():
    model = scene()
    data = data_of(model)
    q = closed(model, data)
    least = least_torque(model, data, q)
    print(f"a box of {MASS} kg between two fingers, friction {MU}: the knuckle needs {least:.4f} N m")
    for share in (1.02, 1.5, 0.98):
        sunk, forces = hold(model, q, share * least)
        up, slide = forces[:, 2].sum(), np.linalg.norm(forces[:, [0, 2]],
                                                       axis=1).sum() / np.abs(forces[:, 1]).sum() if len(forces) else 0.0
        print(f"  with {share:4.2f} of that the box sinks {1e3 * sunk:.3g} mm in 0.5 s; the fingers carry {up:.4g} N of {MASS * 9.81:.4g} N, at {slide:.2f} of the normal force")
        if share > 1:
            assert abs(sunk) < 1e-5 and abs(up - MASS * 9.81) < 1e-5 and slide < MU, "it holds"
        else:
            assert sunk > 5e-3, "it slips"


if __name__ == "__main__":
    main()
