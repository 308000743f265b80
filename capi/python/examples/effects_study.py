"""What a scene calls for: which effects matter to a result, and what the others cost.

    python effects_study.py

A free arm falls for half a second. `dyn effects --suggest e` leaves out each effect, measures by how much the result moves, and
finds the most that can be left out together while it moves by less than e. Here the same is done by hand, beside it: switch an
effect off, look at what changes. What is absent needs no switch: it has no memory and takes no time.
"""

import json
import subprocess
from pathlib import Path

import numpy as np

import libdyn as dyn

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"
DURATION, ALLOWED = 0.5, 1e-2
JOINTS = dyn.Effect.DAMPING | dyn.Effect.FRICTION | dyn.Effect.LIMITS | dyn.Effect.ARMATURE


def fall(model, effects=JOINTS, contact=True, gravity=None):
    """q at the end, and the data."""
    data = model.data()
    data.set_effects(effects)
    for pair in range(model.npairs):
        data.set_pair(pair, contact and data.pair_reason(pair) == dyn.PairReason.TESTED)
    if gravity is not None:
        data.set_gravity(gravity)
    data.set_state(model.neutral(), np.zeros(model.nv))
    data.set_step_options("semi_implicit_euler", 1e-3)
    data.advance(DURATION)
    return np.array(data.q), data


def main():
    model = dyn.load(PANDA, base="fixed")
    words = [dyn.accuracy.command(), "effects", str(PANDA), "--fixed", "--duration", str(DURATION), "--suggest", str(ALLOWED),
             "--json"]
    found = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    measured = {e["name"]: e["magnitude"] for e in found["effects"] if e.get("magnitude") is not None}
    complete, data = fall(model)
    by_hand = {
        "gravity": fall(model, gravity=(0, 0, 0))[0],
        "damping": fall(model, JOINTS & ~dyn.Effect.DAMPING)[0],
        "friction": fall(model, JOINTS & ~dyn.Effect.FRICTION)[0],
        "limits": fall(model, JOINTS & ~dyn.Effect.LIMITS)[0],
        "contact": fall(model, contact=False)[0],
    }
    print(f"{model.name} falls for {DURATION} s; without an effect a joint ends elsewhere by (rad, m), and a frame by (dyn "
          "effects: m, rad)")
    for name, q in by_hand.items():
        moved = np.abs(model.difference(complete, q)).max()
        print(f"  {name:10} {moved:9.2g}   {measured[name]:9.2g}")
        assert (moved < ALLOWED) == (measured[name] < ALLOWED), "both say alike what matters"
    out = found["suggested"]["without"]
    print(f"for {ALLOWED:g} the scene does without {', '.join(out)}: {found['suggested']['options']} changes the result by "
          f"{found['suggested']['error']:.2g}")
    assert out and found["suggested"]["error"] < ALLOWED and "gravity" not in out and "limits" not in out

    # absent: no spring, no actuator, no medium in this scene, and nothing of them in its memory
    plan = data.plan()
    for name in ("springs", "actuators", "fluid", "constraints"):
        assert plan[name].present == 0 and plan[name].bytes == 0, name
    without = fall(model, contact=False)[1].plan()["contact"]
    print(f"springs, actuators, a medium and constraints are absent: 0 bytes. Contact, switched off: {without.acting} of "
          f"{without.present} pairs are tested")
    assert without.acting == 0 and plan["contact"].acting > 0


if __name__ == "__main__":
    main()
