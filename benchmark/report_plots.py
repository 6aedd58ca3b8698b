"""The plots of report.py, and who is told of in which order, in plots and in tables."""

import matplotlib
import numpy as np

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of what draws)
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402

YARDSTICK = "Embree"
KNOWN = "Embree, previous known"
PLAIN = "plain search, unmeasured"
OWN_UPDATE, THEIR_UPDATE = "this library", "Embree, refit"
ORDER = ["greedy, unmeasured", "greedy, unsigned", "greedy", "4 leaves", "16 leaves", "1 %", "exact", "exact, unsigned",
         "exact, previous known", "exact, unsigned, previous known", "exact, all cores", YARDSTICK,
         "Embree, robust", KNOWN, "Embree, all cores", "CGAL", "CGAL, previous known", "FCL OBBRSS",
         "nanoflann on centroids", PLAIN, "plain search, float", "brute force", OWN_UPDATE, OWN_UPDATE + ", partial", THEIR_UPDATE, "Embree, static",
         "FCL OBBRSS, top down", "Bullet", "Bullet, partial"]
SHARES_AT = 32768  # triangles, about, of the organ of which some vertices move in the plot
# For want of room: who tells normal and sign is not far from who does not.
NOT_DRAWN = ["greedy", "plain search, float", "4 leaves", "exact", "exact, previous known", "Embree, robust"]
COLOURS = ["#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"]  # Okabe and Ito (2008)


# ---- for the tables too

def thousands(count):
    return f"{count:,}"


def entrants(organs, kind, task):
    names = []
    for organ in organs.values():
        names += [name for name in organ.get(kind, {}).get(task, {}) if name not in names]
    return sorted(names, key=rank)


def rank(name):
    return ORDER.index(name) if name in ORDER else len(ORDER)


# ---- plots

def draw_growth(organs, file):
    blobs = {name: organ for name, organ in organs.items() if name.startswith("blob") and "query" in organ}
    figure, axes = plt.subplots(2, 2, figsize=(10, 8), sharex=True)
    who_all = [who for who in entrants(blobs, "query", "trajectory") if who not in NOT_DRAWN]
    for axis, task in zip(axes.flat, ("near", "far", "inside", "trajectory")):
        for i, who in enumerate(who_all):
            points = [(organ["triangles"], 1e9 * organ["query"][task][who]["times"][0])
                      for organ in blobs.values() if who in organ["query"].get(task, {})]
            if points:
                axis.loglog(*zip(*points), marker=".", label=who, color=COLOURS[i % len(COLOURS)],
                            linestyle="-" if i < len(COLOURS) else "--")
        axis.set(title=task, xlabel="triangles", ylabel="time per query [ns]")
        axis.grid(alpha=0.3)
        axis.tick_params(labelbottom=True)
    figure.legend(*axes[1, 1].get_legend_handles_labels(), loc="lower center", ncol=4)
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    figure.savefig(file)


def draw_updates(organs, file):
    """Build and following all vertices by triangles; following some of one organ's vertices by how many."""
    blobs = {name: organ for name, organ in organs.items() if name.startswith("blob") and "update" in organ}
    names = sorted({who for organ in blobs.values() for task in organ["update"].values() for who in task}, key=rank)
    styles = {who: {"marker": ".", "label": who, "color": COLOURS[i % len(COLOURS)],
                    "linestyle": "-" if i < len(COLOURS) else "--"} for i, who in enumerate(names)}
    figure, axes = plt.subplots(1, 3, figsize=(14, 5))
    for axis, task, title in zip(axes, ("build", "all vertices"), ("build", "follow all vertices")):
        for who in entrants(blobs, "update", task):
            points = [(organ["triangles"], 1e3 * organ["update"][task][who]["times"][0])
                      for organ in blobs.values() if who in organ["update"][task]]
            axis.loglog(*zip(*points), **styles[who])
        axis.set(title=title, xlabel="triangles", ylabel="time [ms]")
    one = min(blobs.values(), key=lambda organ: abs(np.log(organ["triangles"] / SHARES_AT)))
    for who in names:
        points = sorted((entry[who]["moved"], 1e3 * entry[who]["times"][0])
                        for task, entry in one["update"].items() if task != "build" and who in entry)
        if points:
            axes[2].loglog(*zip(*points), **styles[who])
    axes[2].set(title=f"follow moved vertices, {thousands(one['triangles'])} triangles",
                xlabel="vertices moved (dots at the right: all)", ylabel="time [ms]")
    for axis in axes:
        axis.grid(alpha=0.3)
    figure.legend([plt.Line2D([], [], **styles[who]) for who in names], names, loc="lower center", ncol=5)
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    figure.savefig(file)


def draw_latency(nodes, file):
    figure, all_axes = plt.subplots(len(nodes), 1, figsize=(8, 3 * len(nodes)), sharex=True, squeeze=False)
    for axis, (how, node) in zip(all_axes.flat, nodes.items()):
        ends, counts = np.array(node["histogram_us"]).T
        axis.bar(ends, counts / node["sent"], width=-0.1 * ends, align="edge", color=COLOURS[4])
        for key, text in (("p50_us", "p50"), ("p99_us", "p99"), ("max_us", "max")):
            if node[key] is None:  # lost
                continue
            axis.axvline(node[key], color=COLOURS[5], linewidth=1)
            axis.annotate(text, (node[key], axis.get_ylim()[1]), ha="center", va="bottom")
        axis.set(xscale="log", ylabel="share of tips")
        axis.set_title(how, loc="left", fontsize="medium", pad=16)
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.tick_params(labelbottom=True)
    all_axes[-1, 0].set_xlabel("from the transform sent to the contact received [µs]")
    figure.tight_layout()
    figure.savefig(file)


def draw(results, folder):
    plt.rcParams.update({"svg.hashsalt": "organ_collision", "svg.fonttype": "none"})
    draw_growth(results["organs"], folder / "performance_growth.svg")
    draw_updates(results["organs"], folder / "performance_updates.svg")
    if results["node_latency"]:
        draw_latency(results["node_latency"], folder / "performance_latency.svg")
