"""A box is thrown onto the floor: its contact forces, where it stops, and a page of it.

    python thrown_box.py [PAGE.html]
"""

from __future__ import annotations

import sys

import numpy as np

import libdyn as dyn

SCENE = """<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="box" pos="0 0 0.5">
      <freejoint name="box"/><geom type="box" size="0.1 0.1 0.1" mass="2"/><site name="middle"/>
    </body>
  </worldbody>
  <sensor><accelerometer name="imu" site="middle"/></sensor>
</mujoco>"""


def main(page: str | None = None) -> dyn.Recording:
    model = dyn.load_string(SCENE)
    sim = dyn.Simulation(model, v=[2, 0, 1, 0, 3, 0])  # in the box's axes: forward, upward, and turning about y
    recording = sim.record(every=1)
    weight = 9.81 * model.total_mass

    sim.run(0.1)
    falls = np.abs(sim.sensors["imu"]).max()
    assert falls < 0.1 and not sim.contacts, "what falls freely measures no acceleration, but for the mean over a step"
    sim.run(2.9)

    pressed = np.array([sum(c.force_on_b[2] for c in contacts) for contacts in recording.contacts])
    first = recording.t[np.argmax(pressed > 0)]
    print(f"it lands after {first:.3f} s; the floor presses with up to {pressed.max() / weight:.0f} weights")
    print(f"at the end {len(sim.contacts)} corners carry {pressed[-1] / weight:.4f} weights, {sim.q[0]:.2f} m away")
    assert len(sim.contacts) == 4 and abs(pressed[-1] / weight - 1) < 1e-3

    # momentum: what the floor gives along z is what gravity takes, and the change
    upward = model.total_mass * (0 - 1.0)  # kg m/s: at rest, after it was thrown with 1 m/s
    impulse = pressed[1:].sum() * sim.dt
    assert abs(impulse - weight * recording.t[-1] - upward) < 1e-2 * impulse
    print(f"impulse of the floor {impulse:.3f} N s, of gravity {weight * recording.t[-1]:.3f} N s")

    speed = np.linalg.norm(recording.v[-1])
    assert speed < 1e-3
    lost = recording.energy[0].sum() - recording.energy[-1].sum()
    print(f"friction and impacts took {lost:.2f} J")
    if page:
        recording.to_html(page)
        print(f"open {page}")
    return recording


if __name__ == "__main__":
    main(*sys.argv[1:])
