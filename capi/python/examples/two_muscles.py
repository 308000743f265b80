"""A forearm between two muscles that wrap around the elbow: their activations set where it rests, and how stiffly.

    python two_muscles.py

The difference of the activations turns the elbow. Their sum makes it stiff: a push moves it less.
"""

import numpy as np

import libdyn as dyn


X = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), np.zeros(3)  # z, the cylinder's axis, along the elbow's


def arm():
    b = dyn.Builder("arm").set_gravity((0, 0, 0))
    b.add_joint("elbow", "revolute", axis=(0, 1, 0), lower=[-0.6], upper=[0.6], damping=[0.3])
    b.add_body("forearm", "elbow", 1.5, (0.15, 0, 0), np.diag([1e-3, 1e-2, 1e-2])).add_frame("bone", "elbow", X)
    for name, side in (("flexor", 1), ("extensor", -1)):
        b.add_frame(f"{name}_origin", None, (-0.25, 0, 0.005 * side))
        b.add_frame(f"{name}_end", "forearm", (0.06, 0, 0.005 * side))
        b.add_frame(f"{name}_side", None, (0, 0, 0.1 * side))
        b.add_tendon(name, [("site", f"{name}_origin"), ("cylinder", "bone", 0.03, f"{name}_side"), ("site", f"{name}_end")],
                     type="spatial")
        b.add_actuator(name, name, type="muscle", transmission="tendon",
                       muscle=dyn.Muscle(force=400, range=(0.75, 0.95), length_range=(0.30, 0.34)))
    return b.finish()


def rest(model, flexor, extensor, push=0.0):
    """The angle where the elbow comes to rest, rad."""
    d = model.data()
    d.set_control([flexor, extensor])
    d.set_state(tau=[push])
    d.advance(20.0)
    assert abs(d.v[0]) < 1e-5
    return d.q[0], d


def main():
    model = arm()
    print("  flexor  extensor  angle (deg)  moment arms (mm)  moves by a push of 0.05 N m (deg)")
    stiffness = {}
    for flexor, extensor in ((0.1, 0.1), (0.22, 0.2), (0.2, 0.22), (0.5, 0.5), (1.0, 1.0)):
        angle, d = rest(model, flexor, extensor)
        arms = 1e3 * d.tendons().J[:, 0]
        moved = abs(rest(model, flexor, extensor, 0.05)[0] - angle)
        stiffness[flexor, extensor] = 0.05 / moved
        print(f"  {flexor:6} {extensor:9} {np.degrees(angle):12.2f} {arms[0]:9.2f} {arms[1]:6.2f} {np.degrees(moved):14.2f}")
    assert abs(rest(model, 0.3, 0.3)[0]) < 1e-6  # equal muscles: straight
    assert rest(model, 0.22, 0.2)[0] < -0.05 < 0.05 < rest(model, 0.2, 0.22)[0]
    assert stiffness[1.0, 1.0] > 2 * stiffness[0.1, 0.1]
    print(f"both muscles together make the elbow {stiffness[1.0, 1.0] / stiffness[0.1, 0.1]:.1f} times as stiff")


if __name__ == "__main__":
    main()
