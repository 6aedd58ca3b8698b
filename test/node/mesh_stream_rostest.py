#!/usr/bin/env python3
"""The organ deforms by a stream, while contacts and questions go on."""
import math
import re
import threading
import time

import numpy as np
import rospy
from deforming_liver import REFITS, DeformingLiver
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Log
from rostest_support import Inbox, Services, contact_of, run

from organ_collision.msg import MeshInfo
from organ_collision.srv import UpdateMeshRequest

STREAM_RATE = 60  # [Hz]
BURST_RATE = 1e6  # [Hz] as fast as Python can
LOG_LIMIT = 5.1  # [s] after which what is the same but for numbers is logged again
REFUSALS_PERIOD = 0.1  # [s] at which they are told
NO_AREA = " triangles have no area"


class MeshStream(DeformingLiver):
    def send_and_follow(self, updates, frequency=STREAM_RATE, last_actions=REFITS):
        """Sends (positions, indices) so often [Hz], waits until all have arrived, and checks what they led to. Each
        update becomes a version of its own or is merged with a later one; returns how many were merged."""
        start = self.account()
        expected = self.loaded.vertices.copy()
        rate = rospy.Rate(frequency)
        for positions, indices in updates:
            expected[indices if len(indices) else slice(None)] = np.asarray(positions, np.float32)
            self.send(positions, indices)
            rate.sleep()
        end = self.latest_info(lambda info: info.mesh_version + info.updates_merged ==
                               start.mesh_version + start.updates_merged + len(updates))
        self.assertEqual(end.updates_lost, start.updates_lost)
        self.assertGreater(end.mesh_version, start.mesh_version)
        self.assertIn(end.last_action, last_actions)
        np.testing.assert_array_equal(self.services.surface().vertices, expected)
        self.check_queries(self.loaded.of(expected), end.mesh_version)
        return end.updates_merged - start.updates_merged

    def test_a_stream_of_whole_updates_leads_to_its_last_state(self):
        self.send_and_follow([(self.deformed(phase=0.1 * i), ()) for i in range(STREAM_RATE)])

    def test_nothing_is_lost_of_a_stream_of_partial_updates(self):
        vertices = np.random.default_rng(4).permutation(len(self.loaded.vertices))
        moved = self.deformed()
        self.send_and_follow([(moved[part], part) for part in np.array_split(vertices, STREAM_RATE)])

    def test_a_stream_of_whole_and_partial_updates_leads_to_its_last_state(self):
        random = np.random.default_rng(5)
        updates = []
        for i in range(STREAM_RATE // 2):
            part = random.choice(len(self.loaded.vertices), 50, replace=False)
            updates += [(self.deformed(phase=0.1 * i), ()), (self.deformed(phase=0.1 * i, size=0.02)[part], part)]
        self.send_and_follow(updates)

    def test_nothing_is_lost_of_a_burst_of_partial_updates(self):
        vertices = np.random.default_rng(6).permutation(len(self.loaded.vertices))
        for phase in range(10):  # an idle machine may keep up with a burst
            moved = self.deformed(phase=phase)
            if self.send_and_follow([(moved[part], part) for part in np.array_split(vertices, 4000)], BURST_RATE) > 0:
                return
        self.fail("of ten bursts none was merged")

    def test_a_burst_of_whole_updates_leads_to_its_last_state(self):
        self.send_and_follow([(self.deformed(phase=0.1 * i), ()) for i in range(20)], BURST_RATE)

    def test_contacts_go_on_while_updates_stream_in(self):
        stop = threading.Event()

        def stream():
            rate = rospy.Rate(STREAM_RATE)
            while not stop.is_set():
                self.send(self.deformed(phase=rospy.get_time()))
                rate.sleep()

        thread = threading.Thread(target=stream)
        thread.start()
        try:
            versions = {contact_of(array, "fixed").mesh_version for array in self.contacts.collect(60)}
        finally:
            stop.set()
            thread.join()
        self.assertGreater(len(versions), 10, "the organ moves")
        self.assertGreater(len(versions), 0.5 * (max(versions) - min(versions)), "contacts follow it")

    def test_a_stream_leads_to_its_last_state_while_the_organ_is_rebuilt_over_and_over(self):
        stop = threading.Event()

        def rebuild():
            rebuilder = Services()
            while not stop.is_set():
                rebuilder.update(mode=UpdateMeshRequest.REBUILD)

        thread = threading.Thread(target=rebuild)
        thread.start()
        try:
            self.send_and_follow([(self.deformed(phase=0.1 * i), ()) for i in range(STREAM_RATE)],
                                 last_actions=(MeshInfo.REBUILD, *REFITS))
        finally:
            stop.set()
            thread.join()

    def test_bad_streamed_updates_are_refused_whole_and_counted(self):
        nan = self.deformed()
        nan[17, 1] = math.nan
        count = len(nan)
        bad_updates = {
            "NaN": dict(positions=nan),
            "one vertex too few": dict(positions=nan[18:]),
            "half a vertex": dict(positions=np.ravel(self.loaded.vertices)[:-1]),
            "a repeated index": dict(positions=nan[:2], indices=[7, 7]),
            "an index out of range": dict(positions=nan[:2], indices=[7, count]),
            "the wrong frame": dict(positions=self.deformed(), frame="table"),
        }
        not_counted = []
        for what, bad in bad_updates.items():
            before = self.account()
            self.infos.forget()
            self.send(**bad)
            self.send(self.loaded.vertices[:1], [0])
            after = self.latest_info(lambda info: info.mesh_version > before.mesh_version)
            self.assertEqual(after.mesh_version, before.mesh_version + 1, what)
            if after.updates_lost != before.updates_lost + 1:
                not_counted.append(what)
        expected = self.loaded.vertices.copy()
        expected[0] = expected[0].astype(np.float32)
        np.testing.assert_array_equal(self.services.surface().vertices, expected)
        self.assertEqual(not_counted, [])

    def test_many_refusals_are_told_together(self):
        before = self.account()
        self.infos.forget()
        start = time.monotonic()
        refused = 300
        for _ in range(refused):
            self.send(self.loaded.vertices[1:])
            time.sleep(0.001)
        self.latest_info(lambda info: info.updates_lost == before.updates_lost + refused)
        self.assertLess(len(self.infos.all()), 2 + (time.monotonic() - start) / REFUSALS_PERIOD)

    def test_an_update_of_an_unknown_organ_changes_nothing(self):
        before = self.account()
        self.send(self.deformed(), organ="spleen")
        self.send(self.loaded.vertices[:1], [0])
        after = self.latest_info(lambda info: info.mesh_version > before.mesh_version)
        self.assertEqual(after.mesh_version, before.mesh_version + 1)
        self.assertEqual(after.updates_lost, before.updates_lost, "it was not this organ's")
        np.testing.assert_array_equal(self.services.surface().vertices[1:], self.loaded.vertices[1:])

    def test_a_changing_number_of_triangles_without_area_is_told_once(self):
        log = Inbox("/rosout", Log)
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        counts = set()
        for crushed in (50, 100):
            time.sleep(LOG_LIMIT)
            vertices = self.loaded.vertices.copy()
            vertices[:crushed] = vertices[0]
            start = rospy.Time.now()
            self.send(vertices)
            told = diagnostics.wait_for(lambda array: array.header.stamp > start and NO_AREA in str(array.status))
            counts.add(re.search(r"\d+" + NO_AREA, str(told.status)).group())
        self.assertEqual(len(counts), 2, counts)
        warnings = [entry.msg for entry in log.all() if "as it is now" in entry.msg and NO_AREA in entry.msg]
        self.assertEqual(len(warnings), 1, warnings)

    def test_an_update_in_millimetres_is_told(self):
        log = Inbox("/rosout", Log)
        start = rospy.get_time()
        self.send(1000 * self.loaded.vertices)
        log.wait_for(lambda entry: "millimetres?" in entry.msg and entry.header.stamp.to_sec() > start)


if __name__ == "__main__":
    run(MeshStream)
