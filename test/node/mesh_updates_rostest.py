#!/usr/bin/env python3
"""The organ deforms, by service and by stream, while contacts and questions go on."""
import math
import threading
import unittest

import numpy as np
import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rostest_support import (TOLERANCE, ContactsInbox, Frames, Inbox, Pose, Services, Surface, check_nearest,
                             contact_of, run, wait_until)

from organ_collision.msg import MeshInfo, MeshInfoArray, MeshUpdate
from organ_collision.srv import UpdateMesh, UpdateMeshRequest

AUTO, REFIT, REBUILD = UpdateMeshRequest.AUTO, UpdateMeshRequest.REFIT, UpdateMeshRequest.REBUILD
REFITS = (MeshInfo.REFIT, MeshInfo.PARTIAL_REFIT)
TIP = np.array([0.02, 0.01, 0.12])  # [m] in the organ's frame
STREAM_RATE = 60  # [Hz]
BURST_RATE = 1e6  # [Hz] as fast as Python can


def large_grid():
    """A flat mesh of 100,000 triangles, whose hierarchy takes long to build."""
    side = 225
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    corner = (side * y + x)[:-1, :-1].ravel()
    triangles = np.concatenate([np.column_stack([corner, corner + 1, corner + side]),
                                np.column_stack([corner + 1, corner + side + 1, corner + side])])
    return Surface(0.001 * np.column_stack([x.ravel(), y.ravel(), np.zeros(side * side)]), triangles)


class MeshUpdates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        Frames().fix(("liver", "fixed_tip", Pose(TIP)))
        cls.services = Services()
        cls.loaded = cls.services.surface()
        cls.contacts = ContactsInbox()
        cls.infos = Inbox("organ_collision/mesh_info", MeshInfoArray)
        cls.stream = rospy.Publisher("organ_collision/mesh_update", MeshUpdate, queue_size=100, tcp_nodelay=True)
        wait_until(lambda: cls.stream.get_num_connections() == 1, "the node to hear mesh updates")

    def setUp(self):
        self.version = self.update(self.loaded.vertices, triangles=self.loaded.triangles).mesh_version
        self.contacts.forget()
        self.infos.forget()

    def deformed(self, size=0.01, phase=0.0):
        """The loaded liver's vertices, bent by up to `size` [m]."""
        x, y, z = self.loaded.vertices.T
        return np.column_stack([x, y, z + size * np.sin(30.0 * x + phase) * np.cos(20.0 * y)])

    def update(self, *positions, **fields):
        answer = self.services.update(*positions, **fields)
        self.assertTrue(answer.success, answer.message)
        return answer

    def check_queries(self, surface, version):
        """They see this geometry; contacts too, soon."""
        answer = self.services.find([TIP])
        self.assertEqual(answer.mesh_version, version)
        truth = surface.signed_distance(TIP)
        check_nearest(self, answer.nearest[0], TIP, surface, truth)
        contact = self.contacts.contact("fixed", lambda contact: contact.mesh_version == version)
        check_nearest(self, contact.nearest, TIP, surface, truth)

    def latest_info(self, is_wanted):
        return self.infos.wait_for(lambda array: is_wanted(array.meshes[0])).meshes[0]

    # ---- the service

    def test_a_refit_of_all_vertices_is_seen_by_every_later_query(self):
        moved = self.deformed()
        answer = self.update(moved, mode=REFIT, organ="liver")
        self.assertEqual((answer.mesh_version, answer.action), (self.version + 1, MeshInfo.REFIT))
        self.assertGreater(answer.duration, 0.0)
        self.check_queries(self.loaded.of(moved), self.version + 1)
        info = self.latest_info(lambda info: info.mesh_version == self.version + 1)
        self.assertEqual((info.last_action, info.triangles), (answer.action, len(self.loaded.triangles)))
        low, high = self.loaded.of(moved).box()
        self.assertEqual((info.min.z, info.max.z), (low[2], high[2]))

    def test_triangles_within_a_radius_are_of_the_version_that_they_tell(self):
        moved = self.loaded.of(self.deformed())
        version = self.update(moved.vertices, mode=REFIT).mesh_version
        answer = self.services.find_within(TIP, 2.0 * moved.distance(TIP))
        self.assertEqual(answer.mesh_version, version)
        self.assertAlmostEqual(answer.distances[0], moved.distance(TIP), delta=TOLERANCE)

    def test_a_rebuild_with_new_positions_is_seen_by_every_later_query(self):
        moved = self.deformed()
        answer = self.update(moved, mode=REBUILD)
        self.assertEqual((answer.mesh_version, answer.action), (self.version + 1, MeshInfo.REBUILD))
        self.check_queries(self.loaded.of(moved), self.version + 1)

    def test_left_to_the_node_an_update_is_seen_by_every_later_query(self):
        moved = self.deformed(size=0.05)
        answer = self.update(moved, mode=AUTO)
        self.assertEqual(answer.mesh_version, self.version + 1)
        self.assertIn(answer.action, (MeshInfo.REFIT, MeshInfo.REBUILD))
        self.check_queries(self.loaded.of(moved), self.version + 1)

    def test_a_partial_update_moves_the_named_vertices_only(self):
        nearest = self.services.find([TIP]).nearest[0].triangle
        indices = list(self.loaded.triangles[nearest][::-1])
        moved = self.loaded.vertices.copy()
        moved[indices] += [[0.001, 0.0, 0.002], [0.0, 0.002, 0.003], [0.0, 0.0, 0.004]]
        answer = self.update(moved[indices], indices=indices, mode=REFIT)
        self.assertIn(answer.action, REFITS)
        np.testing.assert_array_equal(self.services.surface().vertices, moved)
        self.check_queries(self.loaded.of(moved), self.version + 1)

    def test_a_partial_refit_is_told_with_its_reason(self):
        # A number of vertices not tried since setUp() gave the organ a new topology, so that it is tried.
        few, more = list(range(20)), list(range(1000, 1100))
        lifted = self.loaded.vertices + [0.0, 0.0, 0.001]
        answer = self.update(lifted[few], indices=few, mode=AUTO)
        self.assertEqual(answer.action, MeshInfo.PARTIAL_REFIT)
        self.assertIn(f"20 of {len(lifted)} vertices moved", answer.message)
        info = self.latest_info(lambda info: info.mesh_version == answer.mesh_version)
        self.assertEqual((info.last_action, info.reason), (answer.action, answer.message))
        self.send(lifted[more], more)
        info = self.latest_info(lambda info: info.mesh_version == answer.mesh_version + 1)
        self.assertEqual(info.last_action, MeshInfo.PARTIAL_REFIT)
        self.assertIn("streamed: 100 of", info.reason)

    def test_questions_do_not_wait_for_rebuilds(self):
        large = large_grid()
        self.update(large.vertices, triangles=large.triangles)
        rebuilds = [threading.Thread(target=lambda: Services().update(mode=REBUILD)) for _ in range(12)]
        for rebuild in rebuilds:
            rebuild.start()
        answered = 0
        while any(rebuild.is_alive() for rebuild in rebuilds):
            self.services.find([TIP])
            answered += 1
        self.assertGreater(answered, len(rebuilds))

    def test_left_to_the_node_the_hierarchy_is_rebuilt_when_queries_have_lost_enough(self):
        crushed = self.loaded.vertices * [0.02, 1.0, 1.0]
        self.assertEqual(self.update(crushed, mode=AUTO).action, MeshInfo.REFIT)
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        self.infos.forget()

        def rebuilt():
            self.services.find(np.repeat(crushed, 2, axis=0) + 0.001, max_leaves=1)
            return [array.meshes[0] for array in self.infos.all() if array.meshes[0].last_action == MeshInfo.REBUILD]

        wait_until(rebuilt, "a rebuild", seconds=60.0)
        info = rebuilt()[0]
        self.assertEqual((info.mesh_version, info.cost_ratio), (self.version + 1, 1.0))
        self.assertIn("queries lost", info.reason)
        self.check_queries(self.loaded.of(crushed), self.version + 1)
        told = diagnostics.wait_for(lambda array: any(
            value.key == "liver last build" and value.value == info.reason
            for status in array.status for value in status.values))
        self.assertTrue(told)

    def test_diagnostics_warn_of_what_is_refused_and_of_which_organ(self):
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        for organ in ("liver", "lever"):
            self.send(self.loaded.vertices[:-1], organ=organ)
            diagnostics.wait_for(lambda array: any(
                status.level == DiagnosticStatus.WARN and "mesh updates refused: 1, the last" in status.message
                and f"'{organ}'" in status.message for status in array.status))

    def test_neither_streams_nor_contacts_wait_for_rebuilds(self):
        stop = threading.Event()

        def rebuild():
            rebuilder = Services()
            while not stop.is_set():
                rebuilder.update(mode=REBUILD)

        thread = threading.Thread(target=rebuild)
        thread.start()
        try:
            self.send_and_follow([(self.deformed(phase=0.1 * i), ()) for i in range(STREAM_RATE)],
                                 last_actions=(MeshInfo.REBUILD, *REFITS))
        finally:
            stop.set()
            thread.join()

    def test_a_rebuild_alone_does_not_raise_the_version(self):
        answer = self.update(mode=REBUILD)
        self.assertEqual((answer.mesh_version, answer.action), (self.version, MeshInfo.REBUILD))
        self.check_queries(self.loaded, self.version)

    def test_a_refit_without_positions_does_nothing(self):
        answer = self.update(mode=REFIT)
        self.assertEqual((answer.mesh_version, answer.action), (self.version, MeshInfo.NONE))

    def test_a_new_topology_replaces_the_mesh(self):
        lower = self.loaded.triangles[self.loaded.corners[:, :, 2].max(axis=1) < 0.03]  # cut open
        answer = self.update(self.loaded.vertices, triangles=lower)
        self.assertEqual((answer.mesh_version, answer.action), (self.version + 1, MeshInfo.REBUILD))
        cut = self.services.surface()
        np.testing.assert_array_equal(cut.triangles, lower)
        nearest = self.services.find([TIP]).nearest[0]
        self.assertFalse(nearest.distance_signed)
        self.assertAlmostEqual(nearest.distance, cut.distance(TIP), delta=TOLERANCE)
        contact = self.contacts.contact("fixed", lambda contact: contact.mesh_version == answer.mesh_version)
        self.assertEqual(contact.nearest, nearest)
        info = self.latest_info(lambda info: info.mesh_version == answer.mesh_version)
        self.assertEqual((info.triangles, info.closed), (len(lower), False))
        Inbox("/diagnostics", DiagnosticArray).wait_for(lambda array: any(
            status.level == DiagnosticStatus.WARN and "liver: the surface is not closed" in status.message
            for status in array.status))

    def test_the_expected_version_is_accepted_if_it_is_the_current_one(self):
        self.assertEqual(self.update(self.deformed(), expected_version=self.version).mesh_version, self.version + 1)

    def test_bad_updates_are_refused_whole_and_the_former_mesh_goes_on_answering(self):
        good = self.deformed()
        nan, infinite = good.copy(), good.copy()
        nan[17, 1], infinite[18, 2] = math.nan, math.inf
        count = len(good)
        stranger = self.loaded.triangles.copy()
        stranger[5, 2] = count
        refusals = {
            "a wrong expected version": (good, dict(expected_version=self.version + 5), str(self.version + 5)),
            "one vertex too few": (good[1:], {}, str(count - 1)),
            "one vertex too many": (np.vstack([good, [[0, 0, 0]]]), {}, str(count + 1)),
            "half a vertex": (np.ravel(good)[:-1], {}, str(3 * count - 1)),
            "a repeated index": (good[:3], dict(indices=[7, 8, 7]), "7"),
            "an index out of range": (good[:2], dict(indices=[7, count]), str(count)),
            "fewer positions than indices": (good[:2], dict(indices=[7, 8, 9]), "3"),
            "indices without positions": ([], dict(indices=[7, 8, 9]), "indices"),
            "NaN": (nan, {}, "17"),
            "infinity": (infinite, {}, "18"),
            "NaN in a partial update": (nan[[16, 17]], dict(indices=[16, 17]), "17"),
            "the wrong frame": (good, dict(frame="table"), "table"),
            "no frame": (good, dict(frame=""), "frame_id"),
            "an unknown organ": (good, dict(organ="spleen"), "spleen"),
            "an unknown mode": (good, dict(mode=3), "mode"),
            "a corner out of range": (good, dict(triangles=stranger), str(count)),
            "a topology with indices": (good, dict(triangles=self.loaded.triangles, indices=[1]), "indices"),
            "a topology with NaN": (nan, dict(triangles=self.loaded.triangles), "17"),
            "a topology with a wrong expected version":
                (good, dict(triangles=self.loaded.triangles, expected_version=self.version + 5),
                 str(self.version + 5)),
        }
        before = self.contacts.contact("fixed", lambda contact: contact.mesh_version == self.version)
        complaints = []
        for what, (positions, fields, name) in refusals.items():
            start = rospy.get_time()
            answer = self.services.update(positions, **fields)
            if answer.success or name not in answer.message or rospy.get_time() - start > 1.0:
                complaints.append((what, answer.success, answer.message, rospy.get_time() - start))
        self.assertEqual(complaints, [])
        mesh = self.services.get_mesh()
        self.assertEqual(mesh.mesh_version, self.version)
        np.testing.assert_array_equal(self.services.surface().vertices, self.loaded.vertices)
        self.contacts.forget()
        after = self.contacts.contact("fixed")
        self.assertEqual((after.mesh_version, after.nearest), (before.mesh_version, before.nearest))

    def test_mesh_info_tells_what_was_applied_before_an_update_was_refused(self):
        refused = UpdateMeshRequest(organ="liver", expected_version=1)
        refused.header.frame_id = "liver"
        update = rospy.ServiceProxy("organ_collision/update_mesh", UpdateMesh, persistent=True)
        for i in range(200):  # it is seldom that the refused one comes first to what was streamed
            before = self.services.get_mesh().mesh_version
            self.send(self.loaded.vertices[:1] + [0.0, 0.0, 1e-5 * i], indices=[0])
            self.assertFalse(any(update(refused).success for _ in range(3)))
            wait_until(lambda: self.services.get_mesh().mesh_version > before, "the streamed update")
            version = self.services.get_mesh().mesh_version
            self.latest_info(lambda info: info.mesh_version == version)

    def test_a_batch_is_answered_from_one_mesh_version(self):
        lifted = self.loaded.vertices + [0.0, 0.0, 0.005]
        points = np.tile(TIP, (2000, 1))
        distances = {}  # by whether the version's distance from the first is odd
        for parity, vertices in enumerate((self.loaded.vertices, lifted)):
            distances[parity] = self.loaded.of(vertices).signed_distance(TIP)
        stop = threading.Event()

        def flip():
            flipper = Services()
            parity = 1
            while not stop.is_set():
                flipper.update((self.loaded.vertices, lifted)[parity], mode=REFIT)
                parity = 1 - parity

        thread = threading.Thread(target=flip)
        thread.start()
        versions = set()
        try:
            for _ in range(30):
                answer = self.services.find(points)
                versions.add(answer.mesh_version)
                truth = distances[(answer.mesh_version - self.version) % 2]
                seen = np.array([nearest.distance for nearest in answer.nearest])
                np.testing.assert_allclose(seen, truth, rtol=0, atol=TOLERANCE)
        finally:
            stop.set()
            thread.join()
        self.assertGreater(len(versions), 2)

    # ---- the stream

    def send(self, positions, indices=(), frame="liver", organ="liver"):
        message = MeshUpdate(organ=organ, indices=indices, positions=np.ravel(positions).astype(np.float32))
        message.header.frame_id = frame
        self.stream.publish(message)

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

    def account(self):
        """The node's, of the current version."""
        self.infos.forget()
        self.update(mode=REBUILD)
        return self.latest_info(lambda info: info.last_action == MeshInfo.REBUILD)

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
            if self.send_and_follow([(moved[part], part) for part in np.array_split(vertices, 90)], BURST_RATE) > 0:
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
        self.assertGreater(len(versions), 30, "contacts follow the organ")

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

    def test_an_update_of_an_unknown_organ_changes_nothing(self):
        before = self.account()
        self.send(self.deformed(), organ="spleen")
        self.send(self.loaded.vertices[:1], [0])
        after = self.latest_info(lambda info: info.mesh_version > before.mesh_version)
        self.assertEqual(after.mesh_version, before.mesh_version + 1)
        self.assertEqual(after.updates_lost, before.updates_lost, "it was not this organ's")
        np.testing.assert_array_equal(self.services.surface().vertices[1:], self.loaded.vertices[1:])


if __name__ == "__main__":
    run(MeshUpdates)
