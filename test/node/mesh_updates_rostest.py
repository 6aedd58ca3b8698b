#!/usr/bin/env python3
"""The organ deforms by service, while contacts and questions go on."""
import math
import re
import threading

import numpy as np
import rospy
from deforming_liver import REFITS, TIP, DeformingLiver
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log
from rostest_support import TOLERANCE, Inbox, Services, Surface, check_nearest, run, wait_until

from organ_collision.msg import MeshInfo
from organ_collision.srv import UpdateMesh, UpdateMeshRequest, UpdateMeshResponse

AUTO, REFIT, REBUILD = UpdateMeshRequest.AUTO, UpdateMeshRequest.REFIT, UpdateMeshRequest.REBUILD


def large_grid():
    """A flat mesh of 100,000 triangles, whose hierarchy takes long to build."""
    side = 225
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    corner = (side * y + x)[:-1, :-1].ravel()
    triangles = np.concatenate([np.column_stack([corner, corner + 1, corner + side]),
                                np.column_stack([corner + 1, corner + side + 1, corner + side])])
    return Surface(0.001 * np.column_stack([x.ravel(), y.ravel(), np.zeros(side * side)]), triangles)


class MeshUpdates(DeformingLiver):
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

    def test_a_surface_that_crosses_itself_is_told(self):
        log = Inbox("/rosout", Log)
        crossing = self.loaded.vertices.copy()
        crossing[0] = 2 * crossing.mean(axis=0) - crossing[0]
        self.update(crossing, triangles=self.loaded.triangles)
        Inbox("/diagnostics", DiagnosticArray).wait_for(lambda array: any(
            status.level == DiagnosticStatus.WARN and re.search("liver: triangles .* cross or touch", status.message)
            for status in array.status))
        log.wait_for(lambda entry: re.match("'liver', as it is now: triangles .* cross or touch", entry.msg))

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
            version = 0 if what == "an unknown organ" else self.version
            if (answer.action, answer.mesh_version) != (UpdateMeshResponse.NONE, version):
                complaints.append((what, answer.action, answer.mesh_version))
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


if __name__ == "__main__":
    run(MeshUpdates)
