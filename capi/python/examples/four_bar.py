"""A four-bar linkage: a loop that is a constraint, beside its closed form, and the diagnostics of its rows.

    python four_bar.py

Crank 0.4 m, coupler 1 m, rocker 0.8 m, ground 1 m, in the plane of x and y. The file's last hinge is a loop of five rows where
the plane needs two: three are redundant. That changes how the hinge's force is shared among rows, and nothing of the motion.
"""

from pathlib import Path

import numpy as np

import libdyn as dyn

FOUR_BAR = Path(__file__).resolve().parents[3] / "models" / "mechanisms" / "four_bar.urdf"
CRANK, COUPLER, ROCKER, GROUND = 0.4, 1.0, 0.8, 1.0


def closed_form(crank):
    """Angles (crank, coupler - crank, rocker - coupler) of the branch whose coupler lies above the ground."""
    B = CRANK * np.array([np.cos(crank), np.sin(crank)])  # the pin between crank and coupler
    to_ground = np.array([GROUND, 0]) - B
    d = np.linalg.norm(to_ground)
    inner = np.arccos((COUPLER**2 + d**2 - ROCKER**2) / (2 * COUPLER * d))
    coupler = np.arctan2(to_ground[1], to_ground[0]) + inner
    C = B + COUPLER * np.array([np.cos(coupler), np.sin(coupler)])
    rocker = np.arctan2(-C[1], GROUND - C[0])
    return np.array([crank, coupler - crank, rocker - coupler])


def main():
    model = dyn.load(FOUR_BAR, base="fixed")
    data = model.data()

    # closing the loop: from a guess to a configuration that satisfies it
    q = data.project(closed_form(1.0) + [0, 0.05, -0.05]).q
    print(f"projected to q = {np.round(q, 6)}; the closed form for that crank is {np.round(closed_form(q[0]), 6)}")
    assert np.abs(model.difference(closed_form(q[0]), q)).max() < 1e-11

    # what the rows do
    report = data.constraint_report(q)
    kinds = [row.verdict.name for row in report.rows]
    print(f"diagnostics: {len(report.rows)} rows, rank {report.rank}, {report.redundant} redundant: {', '.join(kinds)}")
    assert report.rank == 2 and report.redundant == 3 and report.contradictory == 0

    # motion: a turning crank; nothing drives, nothing resists, and gravity is normal to the plane
    v = data.project(q, [6.0, 0, 0]).v
    data.set_state(q, v, tau=np.zeros(3))
    data.set_effects(())
    for pair in range(model.npairs):
        data.set_pair(pair, False)
    data.set_step_options("reference", 1e-3)
    start, off, turns, last = data.energy(q, v).kinetic, 0.0, 0.0, q[0]
    drift = 0.0
    for _ in range(3000):
        data.step()
        turns += float(np.arctan2(np.sin(data.q[0] - last), np.cos(data.q[0] - last)))
        last = data.q[0]
        off = max(off, np.abs(model.difference(closed_form(data.q[0]), np.array(data.q))).max())
        drift = max(drift, abs(data.energy().kinetic - start))
    print(f"in 3 s the crank made {turns / (2 * np.pi):.2f} turns; angles differ from the closed form by {off:.1g} rad, energy "
          f"by {drift:.1g} of {start:.3g} J")
    assert abs(turns) > 4 * np.pi and off < 1e-9 and drift < 1e-11 * start

    # what cannot be is named: a second pin, 1 mm beside the first
    beside = {"placement1": (ROCKER, 0, 0), "placement2": (GROUND + 1e-3, 0, 0)}
    data.set_constraint(1, dyn.constraint.connect("rocker", "ground", **beside))
    report = data.constraint_report(q)
    named = sorted({row.constraint for row in report.rows if row.verdict == dyn.RowVerdict.CONTRADICTORY})
    print(f"a second pin 1 mm beside the first: {report.contradictory} rows contradict each other, of {' and '.join(named)}, by "
          f"{report.contradiction:.2g} m")
    assert named == ["pin", "slot 1"] and 1e-4 < report.contradiction < 1e-3


if __name__ == "__main__":
    main()
