#!/usr/bin/env python3
"""The plot of bench/report.py: plot.py FIGURES.json OUT.svg. FIGURES: {"ratios": {row: {model: ratio or null}}, "models": {model: title}, "mean"}."""
import json
import sys
from pathlib import Path

try:
    import matplotlib
except ImportError:
    sys.exit("plot: matplotlib is missing: pip install matplotlib in this Python's environment")
matplotlib.use("svg")
import matplotlib.pyplot as plt

STYLE = {"panda": ("#1b6ca8", "o", "white"), "panda_no_mimic": ("#1b6ca8", "o", None), "go2": ("#d1603d", "s", None),
         "humanoid": ("#2a8f62", "D", None), "chain100": ("#6b4fa0", "^", None)}
INK, FAINT = "#24292f", "#d8dee4"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        figures = json.loads(Path(sys.argv[1]).read_text())
        ratios, models, mean = figures["ratios"], figures["models"], figures["mean"]
    except (OSError, ValueError, KeyError) as e:
        sys.exit(f"plot: {sys.argv[1]}: {e!r}")
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "dyn", "font.family": "sans-serif", "font.size": 9,
                         "text.color": INK, "axes.edgecolor": FAINT, "xtick.color": INK, "ytick.color": INK})
    rows = list(ratios)
    fig, ax = plt.subplots(figsize=(8.2, 0.6 + 0.205 * len(rows)), layout="constrained", facecolor="white")
    ax.axvspan(0.01, 0.6, color="#2a8f62", alpha=0.05, lw=0)
    for k, row in enumerate(rows):
        values = [x for x in ratios[row].values() if x]
        ax.plot([min(values), max(values)], [k, k], color="#b6bfc9", lw=2.2, solid_capstyle="round", zorder=2)
    for model, title in models.items():
        color, marker, face = STYLE.get(model, ("#57606a", "o", None))
        points = [(ratios[row][model], k) for k, row in enumerate(rows) if ratios[row].get(model)]
        ax.scatter(*zip(*points), s=21, marker=marker, facecolor=face or color, edgecolor=color if face else "white",
                   linewidth=1.1 if face else 0.5, zorder=4 if face else 3, label=title)
    for x, style, text in ((0.45, (0, (4, 2)), "0.45"), (0.6, "-", "0.6"), (1, "-", "as fast")):
        ax.axvline(x, color=INK if x < 1 else "#b3261e", lw=0.9, ls=style, zorder=1)
        ax.text(x, -1.1, text, ha="center", va="bottom", fontsize=8, color=INK if x < 1 else "#b3261e")
    ax.axvline(mean, color="#1b6ca8", lw=5, alpha=0.18, zorder=0)
    ax.text(mean, len(rows) - 0.1, f"mean {mean:.2f}", ha="center", va="top", fontsize=8, color="#1b6ca8")
    ax.set_xscale("log")
    values = [x for r in ratios.values() for x in r.values() if x]
    ax.set_xlim(min(values) / 1.15, max(max(values), 1) * 1.15)
    ticks = [t for t in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1, 1.5, 2, 3)
             if min(values) / 1.15 <= t <= max(max(values), 1) * 1.15]
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    ax.set_xticks([], minor=True)
    ax.set_ylim(len(rows) + 0.6, -1.2)
    ax.set_yticks(range(len(rows)), rows)
    ax.tick_params(length=0)
    ax.grid(axis="y", color=FAINT, lw=0.5)
    ax.set_axisbelow(True)
    ax.spines[:].set_visible(False)
    ax.set_xlabel("time of libdyn / time of the fastest build of Pinocchio (logarithmic)")
    fig.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=len(models), frameon=False, handletextpad=0.2,
               columnspacing=1.6)
    fig.savefig(sys.argv[2], metadata={"Date": None})


if __name__ == "__main__":
    main()
