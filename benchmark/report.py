#!/usr/bin/python3
"""Makes tables, JSON and plots of what the benchmarks measured: scripts/benchmark calls it.

Usage: report.py RESULTS PAGE.md
RESULTS has what query_benchmark, update_benchmark and node_latency wrote: query_*.json, update_*.json and, in a folder for
each way, node_latency.json. In PAGE.md the text between `<!-- NAME -->` and `<!-- end -->` is replaced by the table NAME;
performance.json and the plots go beside it.
"""

import json
import math
import pathlib
import re
import sys

import numpy as np

from report_plots import KNOWN, OWN_UPDATE, PLAIN, THEIR_UPDATE, YARDSTICK, draw, entrants, rank, thousands

# What answers a task: like the peers with a distance that has no sign, and with all that it can tell.
OWN = {"trajectory": "exact, unsigned, previous known", "batch": "exact, all cores"}
OWN_WHOLE = {"trajectory": "exact, previous known"}
THEIRS = {"batch": "Embree, all cores"}
# Workload, triangles from and to, ratio to Embree to hold and to aim for.
QUERY_TARGETS = [
    ("near", (2e3, 2e5), 3, 6), ("far", (2e3, 2e5), 4, 7),
    ("near", (4e5, 3e6), 4, 8), ("far", (4e5, 3e6), 8, 15),
    ("trajectory", (2e3, 5e3), 3, 6), ("trajectory", (3e4, 3e6), 6, 10),
]
# The same of the paper's search, which leads to a triangle and does not measure it.
GREEDY_TARGETS = [
    ("near", (2e3, 5e3), 10, 20), ("near", (3e4, 5e4), 15, 30), ("far", (2e3, 5e3), 26, 52),
    ("far", (3e4, 5e4), 52, 104), ("trajectory", (2e3, 5e3), 7.7, 15), ("trajectory", (3e4, 5e4), 10.5, 21),
]
# And as a ratio to the same search written down plainly.
PLAIN_TARGETS = [(task, (2e3, 2e5), 1, 2) for task in ("near", "far", "trajectory")]
UPDATE_TARGETS = [("all vertices", "refit of all vertices", (2e3, 2e5), 1.5, 4),
                  ("build", "build", (2e3, 2e5), 0.5, 1)]
GROWTH_FROM = 2000  # triangles: below, the caches hide the growth, and what is there once weighs


# ---- reading

def repetitions(path):
    """Of a Google Benchmark file: its context, and what each benchmark's repetitions said."""
    file = json.loads(path.read_text())
    runs = {}
    for run in file["benchmarks"]:
        if run["run_type"] == "iteration":
            task, who = run["run_name"].split("/")[:2]
            runs.setdefault(task, {}).setdefault(who, []).append(run)
    return file["context"], runs


def seconds(run, clock):
    return run[clock] * {"ns": 1e-9, "us": 1e-6}[run["time_unit"]]


def four_digits(value):
    return float(f"{value:.4g}")


def query_entry(task, runs):
    clock = "real_time" if task == "batch" else "cpu_time"
    times = sorted(four_digits(seconds(run, clock) / run["tips"]) for run in runs)
    keys = ("tips", "max_error", "mean_error", "found", "bounds", "triangle_tests")
    return {"times": times, **{key: runs[0][key] for key in keys if key in runs[0]}}


def update_entry(runs):
    keys = {"max_error": max, "bytes": min, "hierarchy_bytes": min, "moved": min}
    return {"times": sorted(four_digits(seconds(run, "real_time")) for run in runs),
            **{key: of_all(run[key] for run in runs) for key, of_all in keys.items() if key in runs[0]}}


def read(results):
    """All organs by size, each with queries and updates as [task][who]; the machine; the node's latency."""
    organs, machine, loads = {}, {}, []
    for path in sorted(results.glob("query_*.json")) + sorted(results.glob("update_*.json")):
        context, tasks = repetitions(path)
        kind = path.name.split("_")[0]
        organ = organs.setdefault(context["organ"], {"triangles": int(context["triangles"])})
        organ[kind] = {
            task: {who: query_entry(task, runs) if kind == "query" else update_entry(runs)
                   for who, runs in whos.items()} for task, whos in tasks.items()}
        machine = {key: context[key] for key in ("date", "num_cpus", "mhz_per_cpu")}
        loads.append(context["load_avg"][0])
    if not organs:
        sys.exit(f"{results}: there are no results")
    machine["processor"] = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                                 if line.startswith("model name")), "unknown")
    machine["load"] = [min(loads), max(loads)]
    return {"machine": machine, "organs": dict(sorted(organs.items(), key=lambda item: item[1]["triangles"])),
            "node_latency": {path.parent.name: json.loads(path.read_text())
                             for path in sorted(results.glob("*/node_latency.json"))}}


# ---- figures

def ratio(theirs, ours):
    """How many times faster ours is: by the least times, or by the median of all pairs of repetitions if that is less; and
    the middle half of those pairs."""
    low, median, high = np.percentile(np.divide.outer(theirs["times"], ours["times"]), [25, 50, 75])
    return min(theirs["times"][0] / ours["times"][0], median), low, high


def ratio_text(theirs, ours):
    value, low, high = ratio(theirs, ours)
    return f"{value:.2f} [{low:.2f}-{high:.2f}]"


def growth(organs, value):
    """The exponent of triangles that fits value(organ) best over the blobs from GROWTH_FROM on; None: too few."""
    points = [(organ["triangles"], value(organ)) for name, organ in organs.items()
              if name.startswith("blob") and organ["triangles"] >= GROWTH_FROM]
    if len(points) < 3:
        return None
    return np.polyfit(*np.log(np.array(points)).T, 1)[0]


def work(entry):
    return entry["bounds"] + entry["triangle_tests"]


# ---- tables

def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def verdict(value, hold, aim):
    if value < hold:
        return "**missed**"
    return "aimed for" if value >= aim else "held"


def worst_ratio(organs, sizes, ratio_of):
    """The least ratio over the organs of these sizes, with the organ's name."""
    found = [(ratio_of(organ), name) for name, organ in organs.items()
             if sizes[0] <= organ["triangles"] <= sizes[1] and ratio_of(organ)]
    return min(found) if found else None


def target_row(organs, what, sizes, hold, aim, ratio_of, whole_ratio_of=None):
    worst = worst_ratio(organs, sizes, ratio_of)
    span = f"{sizes[0]:,.0f} to {sizes[1]:,.0f}"
    if worst is None:
        return [what, span, f"{hold}x", f"{aim}x", "not measured", "", ""]
    (value, low, high), name = worst
    whole = f"{worst_ratio(organs, sizes, whole_ratio_of)[0][0]:.2f}x" if whole_ratio_of else ""
    return [what, span, f"{hold}x", f"{aim}x", f"{value:.2f}x [{low:.2f}-{high:.2f}] ({name})",
            verdict(value, hold, aim), whole]


def targets(results):
    organs = results["organs"]
    rows = []

    def add(what, task, sizes, hold, aim, yardstick, ours, whole=None):
        def against(who):
            def ratio_of(organ):
                entries = organ.get("query", {}).get(task, {})
                return ratio(entries[yardstick], entries[who]) if entries else None
            return ratio_of if who else None
        rows.append(target_row(organs, what, sizes, hold, aim, against(ours), against(whole)))

    for task, sizes, hold, aim in QUERY_TARGETS:
        ours = OWN.get(task, "exact, unsigned"), OWN_WHOLE.get(task, "exact")
        add(f"{task}, exact", task, sizes, hold, aim, YARDSTICK, *ours)
        if task == "trajectory":
            add("the same against Embree that knows the previous answer", task, sizes, hold, aim, KNOWN, *ours)
    for task, sizes, hold, aim in GREEDY_TARGETS:
        add(f"{task}, greedy, the triangle", task, sizes, hold, aim, YARDSTICK, "greedy, unmeasured")
        add("the same, the triangle measured", task, sizes, hold, aim, YARDSTICK, "greedy, unsigned", "greedy")
    for task, sizes, hold, aim in PLAIN_TARGETS:
        add(f"{task}, greedy, the triangle, against the plain search", task, sizes, hold, aim, PLAIN, "greedy, unmeasured")
    for task, what, sizes, hold, aim in UPDATE_TARGETS:
        def ratio_of(organ, task=task):
            entries = organ.get("update", {}).get(task, {})
            return ratio(entries[THEIR_UPDATE], entries[OWN_UPDATE]) if entries else None
        rows.append(target_row(organs, what, sizes, hold, aim, ratio_of))
    ratios = table(["against Embree in the same run", "triangles", "hold", "aim", "reached: the worst organ", "",
                    "with normal and sign"], rows)
    return ratios + "\n\n" + table(["otherwise", "target", "reached", ""], other_targets(results))


def other_targets(results):
    organs = results["organs"]
    rows = []

    def add(what, limit, value, text):
        reached = "not measured" if value is None else text
        rows.append([what, f"at most {limit}", reached, "" if value is None else
                     "held" if value <= limit else "**missed**"])

    exponent = growth(organs, lambda organ: work(organ["query"]["near"]["exact"]))
    add("growth of the work of an exact near query (bounds and triangle tests), exponent of the number of triangles",
        0.35, exponent, f"{exponent or 0:.3f}")
    memory = [(organ["update"]["build"][OWN_UPDATE]["hierarchy_bytes"], name) for name, organ in organs.items()
              if "update" in organ and organ["triangles"] >= GROWTH_FROM]
    value, name = max(memory, default=(None, ""))
    add(f"hierarchy and packets (all that searches read), bytes a triangle, from {thousands(GROWTH_FROM)} triangles on",
        120, value, f"{value or 0:.1f} ({name})")
    for how, node in results["node_latency"].items():
        for what, key, limit, scale in (("median [ms]", "p50_us", 0.3, 1e-3), ("99 % [ms]", "p99_us", 1.0, 1e-3),
                                        ("contacts lost", "lost", 0, 1)):
            value = math.inf if node[key] is None else node[key] * scale
            add(f"node end to end, {how}, {what}", limit, value, f"{value:.3g}")
    return rows


def queries(results):
    organs = {name: organ for name, organ in results["organs"].items() if "query" in organ}
    head = ["ns per query"] + [f"{name} {thousands(organ['triangles'])}" for name, organ in organs.items()]
    parts = []
    for task in ("near", "far", "inside", "trajectory", "batch"):
        rows = [[who] + [f"{1e9 * organ['query'][task][who]['times'][0]:,.0f}"
                         if who in organ["query"].get(task, {}) else "" for organ in organs.values()]
                for who in entrants(organs, "query", task)]
        theirs = THEIRS.get(task, YARDSTICK)
        ours = OWN.get(task, "exact, unsigned")
        rows.append([f"*{ours} against {theirs}*"] + [
            ratio_text(entries[theirs], entries[ours]) if entries else ""
            for entries in (organ["query"].get(task, {}) for organ in organs.values())])
        parts.append(f"### {task}\n\n" + table(head, rows))
    return "\n\n".join(parts)


def errors(results):
    """The worst that each entrant did, over all organs and workloads."""
    found = {}
    for organ in results["organs"].values():
        for task in organ.get("query", {}).values():
            for who, entry in task.items():
                found.setdefault(who, []).append(entry)
    rows = [[who, f"{max(entry['max_error'] for entry in found[who]):.1e}",
             f"{max(entry['mean_error'] for entry in found[who]):.1e}",
             f"{100 * min(entry['found'] for entry in found[who]):.1f} %",
             thousands(int(sum(entry["tips"] for entry in found[who])))]
            for who in sorted(found, key=rank)]
    return table(["", "largest error [diagonal]", "mean error, worst workload [diagonal]",
                  "as near as the exact answer, worst workload", "tips"], rows)


def growths(results):
    organs = results["organs"]
    rows = []
    for task in ("near", "far", "inside", "trajectory"):
        row = [task]
        for who, value in (("exact", work), ("exact", None), (YARDSTICK, None), ("CGAL", None)):
            def value_of(organ, task=task, who=who, value=value):
                entry = organ["query"][task][who]
                return value(entry) if value else entry["times"][0]
            exponent = growth(organs, value_of)
            row.append("" if exponent is None else f"{exponent:.2f}")
        rows.append(row)
    return table(["exponent of the number of triangles", "work, exact", "time, exact", "time, Embree", "time, CGAL"], rows)


def updates(results):
    organs = {name: organ for name, organ in results["organs"].items() if "update" in organ}
    head = [f"{name} {thousands(organ['triangles'])}" for name, organ in organs.items()]
    parts = []
    for task, what in (("build", "build [ms]"), ("all vertices", "follow all vertices [ms]")):
        rows = [[who] + [f"{1e3 * organ['update'][task][who]['times'][0]:.3g}" if who in organ["update"][task] else ""
                         for organ in organs.values()] for who in entrants(organs, "update", task)]
        rows.append(["*this library against Embree, refit*"] + [
            ratio_text(organ["update"][task][THEIR_UPDATE], organ["update"][task][OWN_UPDATE])
            for organ in organs.values()])
        parts.append(table([what] + head, rows))
    rows = [[who] + [f"{organ['update']['build'][who]['bytes']:.0f}" if who in organ["update"]["build"] else ""
                     for organ in organs.values()] for who in entrants(organs, "update", "build")]
    parts.append(table(["memory with the mesh [bytes/triangle]"] + head, rows))
    rows = []
    for name, organ in organs.items():
        for task, entries in organ["update"].items():
            if task not in ("build", "all vertices"):
                whole = organ["update"]["all vertices"]
                rows += [[f"{name} {thousands(organ['triangles'])}", int(entry["moved"]), who,
                          f"{1e6 * entry['times'][0]:.3g}",
                          f"{whole[who.split(', partial')[0]]['times'][0] / entry['times'][0]:.1f}x"]
                         for who, entry in entries.items()]
    parts.append(table(["organ", "neighbouring vertices moved", "", "follow them [us]",
                        "against following all"], sorted(rows, key=lambda row: (*row[:2], rank(row[2])))))
    return "\n\n".join(parts)


def latency(results):
    if not results["node_latency"]:
        return "Not measured: the node was not built."
    return table(["", "load average", "triangles", "instruments", "messages", "updates [1/s]", "tips sent", "lost", "p50 [ms]",
                  "p99 [ms]", "p99.9 [ms]", "max [ms]", "cycle in the node, p50 / p99 [ms]"],
                 [[how, node["load"], thousands(node["triangles"]), node["instruments"], node["messages"], node["updates_hz"],
                   thousands(node["sent"]), node["lost"]] +
                  ["lost" if node[key] is None else f"{1e-3 * node[key]:.3f}"
                   for key in ("p50_us", "p99_us", "p999_us", "max_us")] +
                  [f"{1e-3 * node['cycle_p50_us']:.3f} / {1e-3 * node['cycle_p99_us']:.3f}"]
                  for how, node in results["node_latency"].items()])


def machine(results):
    about = results["machine"]
    entries = [organ["query"]["near"]["exact"] for organ in results["organs"].values() if "query" in organ]
    counts = sorted({len(entry["times"]) for entry in entries}, reverse=True)
    return (f"{about['processor']}, {about['num_cpus']} cores of {about['mhz_per_cpu'] / 1000:.1f} GHz, "
            f"{about['date'][:10]}; load average {about['load'][0]:.1f} to {about['load'][1]:.1f} (1 is the benchmark "
            f"itself); {entries[0]['tips']:,.0f} tips a workload, "
            f"{' or, of large organs, '.join(map(str, counts))} repetitions.")


# ---- all

def fill(page, name, text):
    pattern = re.compile(rf"(<!-- {name} -->\n).*?(\n<!-- end -->)", re.DOTALL)
    filled, count = pattern.subn(lambda match: match[1] + text + match[2], page)
    if count != 1:
        sys.exit(f"the page has {count} places for {name}, but 1 is wanted")
    return filled


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    results = read(pathlib.Path(sys.argv[1]))
    page = pathlib.Path(sys.argv[2])
    text = page.read_text()
    for part in (machine, targets, queries, errors, growths, updates, latency):
        text = fill(text, part.__name__, part(results))
    page.write_text(text)
    (page.parent / "performance.json").write_text(json.dumps(results, sort_keys=True) + "\n")
    draw(results, page.parent)


if __name__ == "__main__":
    main()
