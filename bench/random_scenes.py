#!/usr/bin/env python3
"""1,000 random scenes: how many gain energy that nothing explains, how many are refused and why.

    python bench/random_scenes.py [--scenes 1000] [--first 0] [--json FILE]

capi/python/tests/random_scenes.py draws the scenes. A scene gains energy if it exceeds that of its start, and what corrections of
overlaps and soft contacts gave, by more than half of the energy that was ever there.
"""

import argparse
import collections
import json
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
if (ROOT / "build/release/lib").is_dir():
    os.environ.setdefault("DYN_LIBRARY", str(ROOT / "build/release/lib"))
sys.path[:0] = [str(ROOT / "capi/python"), str(ROOT / "capi/python/tests")]
import random_scenes as scenes  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--json", help="file for the counts")
    options = parser.parse_args()
    refusals, gained, broken = collections.Counter(), [], []
    for seed in range(options.first, options.first + options.scenes):
        result = scenes.play(scenes.scene(seed))
        if result.refusal:
            refusals[result.refusal] += 1
        if not result.finite:
            broken.append(seed)
        if result.gain > scenes.SHARE * result.scale:
            gained.append(seed)
    refused = dict(refusals.most_common())
    print(f"{options.scenes} scenes: {len(gained)} gain energy {gained[:20]}, {len(broken)} are not finite {broken[:20]}")
    print(f"{sum(refused.values()):5}  are refused:")
    for reason, n in refused.items():
        print(f"{n:5}  {reason}")
    if options.json:
        counts = {"scenes": options.scenes, "gained": gained, "not_finite": broken, "refused": refused}
        Path(options.json).write_text(json.dumps(counts, indent=1))
    return 1 if gained or broken else 0


if __name__ == "__main__":
    sys.exit(main())
