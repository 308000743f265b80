"""The diagram: a panel a problem, error to the right, time upwards; of each engine the settings that none of its own is both cheaper and nearer than."""

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

COLORS = {"libdyn": ("#1b6ca8", "o"), "MuJoCo": ("#d1603d", "s"), "Drake": ("#2a8f62", "D")}
INK, FAINT = "#24292f", "#d8dee4"
FLOOR = 1e-15  # m: errors below are drawn there


def front(points):
    """Settings that none is both cheaper and nearer than, by error."""
    out = []
    for p in sorted((p for p in points if p.error is not None), key=lambda p: (p.seconds, p.error)):
        if not out or p.error < out[-1].error:
            out.append(p)
    return out


def draw(answers, engines, path):
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "dyn", "font.family": "sans-serif", "font.size": 8,
                         "text.color": INK, "axes.edgecolor": FAINT, "xtick.color": INK, "ytick.color": INK})
    columns = min(5, len(answers))
    rows = -(-len(answers) // columns)
    height = 2.3 * rows + 0.5
    fig, panels = plt.subplots(rows, columns, figsize=(2.5 * columns, height), squeeze=False)
    for ax in panels.flat[len(answers):]:
        ax.axis("off")
    for ax, a in zip(panels.flat, answers.values()):
        ax.set_xscale("log"), ax.set_yscale("log")
        for engine in engines:
            color, marker = COLORS[engine]
            best = front(a["points"][engine])
            ax.plot([max(p.error, FLOOR) for p in best], [p.seconds for p in best], color=color, marker=marker, ms=2.5, lw=1.1,
                    label=engine)
        if a["known_to"]:
            ax.axvline(a["known_to"], color=INK, lw=0.6, ls=(0, (3, 3)))
        ax.set_title(a["title"], fontsize=8)
        ax.grid(color=FAINT, lw=0.4)
        ax.spines[:].set_visible(False)
        ax.tick_params(length=0)
        ax.minorticks_off()
    for k, ax in enumerate(panels.flat[:len(answers)]):
        if k + columns >= len(answers):
            ax.set_xlabel("error, m")
    for row in panels:
        row[0].set_ylabel("time, s")
    fig.legend(*panels[0][0].get_legend_handles_labels(), loc="upper center", ncols=len(engines), frameon=False)
    fig.subplots_adjust(0.06, 0.45 / height, 0.99, 1 - 0.6 / height, 0.25, 0.42)
    fig.savefig(path, metadata={"Date": None})
    plt.close(fig)
