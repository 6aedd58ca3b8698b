#!/usr/bin/python3
"""What benchmark/report.py makes of measurements."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "benchmark"))

import report
import report_plots


def organ(triangles, theirs, ours):
    return {"triangles": triangles, "times": ({"times": theirs}, {"times": ours})}


class Report(unittest.TestCase):

    def test_a_ratio_is_that_of_the_least_times_or_the_median_if_that_is_less(self):
        steady, lucky = {"times": [3.0] * 9}, {"times": [0.95, 0.98, 1.0] + [2.0] * 6}
        self.assertEqual(report.ratio(steady, lucky), (1.5, 1.5, 3.0))
        self.assertAlmostEqual(report.ratio(lucky, steady)[0], 0.95 / 3.0)

    def test_a_target_is_missed_if_one_organ_of_its_sizes_misses_it(self):
        organs = {"small": organ(10, [1.0], [1.0]), "lucky": organ(100, [3.0] * 3, [0.9, 2.0, 2.0]),
                  "fast": organ(200, [7.0], [1.0])}
        rows = {aim: report.target_row(organs, "near", (50, 500), hold, aim, lambda organ: report.ratio(*organ["times"]))
                for hold, aim in ((2, 3), (1.5, 2), (1, 1.5))}
        self.assertIn("1.50x [1.50-", rows[3][4])
        self.assertIn("(lucky)", rows[3][4])
        self.assertEqual([rows[aim][5] for aim in (3, 2, 1.5)], ["**missed**", "held", "aimed for"])
        self.assertIn("not measured", report.target_row(organs, "near", (1e3, 1e4), 1, 2, None))

    def test_a_latency_that_is_that_of_lost_tips_is_lost_and_misses(self):
        node = {"load": 0.5, "triangles": 128, "instruments": 8, "messages": 1, "updates_hz": 60, "sent": 100, "lost": 2,
                "histogram_us": [[125.9, 60], [141.3, 38]], "p50_us": 130.0, "p99_us": None, "p999_us": None, "max_us": None,
                "cycle_p50_us": 10.0, "cycle_p99_us": 50.0}
        results = {"organs": {}, "node_latency": {"busy": node}}
        self.assertIn("| 0.130 | lost | lost | lost |", report.latency(results))
        with tempfile.TemporaryDirectory() as folder:
            report_plots.draw_latency(results["node_latency"], pathlib.Path(folder) / "latency.svg")
        verdicts = {row[0]: row[3] for row in report.other_targets(results)}
        self.assertEqual(verdicts["node end to end, busy, median [ms]"], "held")
        self.assertEqual(verdicts["node end to end, busy, 99 % [ms]"], "**missed**")
        self.assertEqual(verdicts["node end to end, busy, contacts lost"], "**missed**")


if __name__ == "__main__":
    unittest.main()
