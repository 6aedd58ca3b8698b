#!/usr/bin/env python3
"""examples/stream.py in a simulation: the organ moves up and down as a whole, and nothing of the stream is refused."""
import unittest

import numpy as np
from rostest_support import Inbox, Services, SimulatorClock, run, wait_until

from organ_collision.msg import MeshInfoArray


class ExampleStream(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = SimulatorClock(1000.0)

    def test_the_stream_goes_on_where_the_simulation_starts_anew(self):
        infos = Inbox("organ_collision/mesh_info", MeshInfoArray)
        infos.collect(10)
        self.clock.set(1.0)
        infos.collect(10)

    def test_the_organ_breathes(self):
        infos = Inbox("organ_collision/mesh_info", MeshInfoArray)
        services = Services()
        before = services.surface().vertices

        def step():
            """[m] Upwards; of all vertices the same."""
            steps = services.surface().vertices - before
            self.assertLess(np.ptp(steps, axis=0).max(), 1e-6)
            self.assertLess(np.abs(steps[:, :2]).max(), 1e-6)
            return steps[0, 2]

        wait_until(lambda: abs(step()) > 0.002, "2 mm of motion")
        (info,) = infos.wait_for(lambda array: array.meshes[0].mesh_version > 100).meshes
        self.assertEqual(info.updates_lost, 0)


if __name__ == "__main__":
    run(ExampleStream)
