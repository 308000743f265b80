"""Pictures of the environments of libdyn.gym, side by side, and the curve of a training.

    python3 bench/tasks_picture.py --png bench/tasks.png                                 # needs numpy alone
    python3 bench/tasks_picture.py --curve go2.csv --svg bench/learning.svg   # of examples/learn.py; matplotlib
"""

import argparse
import csv

import numpy as np

import libdyn as dyn
from libdyn.gym import TaskEnv

SIZE = 300, 240  # of each


def tasks(path):
    views = (("go2", {"ground": "obstacles", "camera": dyn.Camera(distance=2.2, azimuth=-60)}),
             ("go2", {"ground": "rough", "camera": dyn.Camera(distance=1.6)}), ("humanoid", {}), ("cart_pole", {}),
             ("reach", {}), ("lift", {}))
    rows = []
    for task, options in views:
        env = TaskEnv(task, "rgb_array", width=SIZE[0], height=SIZE[1], **options)
        env.reset(seed=1)
        rows.append(env.render())
    dyn.write_png(np.concatenate([np.concatenate(rows[k : k + 3], axis=1) for k in (0, 3)]), path)


def curve(csv_path, svg_path):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    with open(csv_path, newline="") as file:
        data = np.array(list(csv.reader(file))[1:], float)
    figure, axes = plt.subplots(figsize=(6, 3))
    axes.plot(data[:, 0] / 1e6, data[:, 2])
    axes.set(xlabel="actions, millions", ylabel="mean return of an episode", ylim=(0, None))
    axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(svg_path, metadata={"Date": None})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--png"), parser.add_argument("--curve"), parser.add_argument("--svg")
    given = parser.parse_args()
    if given.png:
        tasks(given.png)
    if given.curve:
        curve(given.curve, given.svg)
