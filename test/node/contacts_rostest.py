#!/usr/bin/env python3
"""Contacts of tips at known places, and how often they come. Frames: table (the scene's) -> liver and -> arm ->
moving_tip move, table -> fixed_tip and liver -> attached_tip do not."""
import unittest

import numpy as np
import rospy
from rostest_support import (PATIENCE, ContactsInbox, Frames, Inbox, Pose, Services, Surface, check_nearest,
                             contact_of, coordinates, run)

from organ_collision.msg import Contact, MeshInfo, MeshInfoArray, NearestTriangle

RANDOM_POSES = 200
HEARTBEAT = 0.1  # [s]
LATE = 1.1  # so many times as long as promised, for a loaded machine


class Contacts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        random = np.random.default_rng(1)
        cls.frames = Frames("organ_collision", "slow")
        cls.table_from_arm = Pose.random(random)
        cls.table_from_fixed = Pose((0.02, -0.01, 0.03))
        cls.organ_from_attached = Pose((0.1, 0.05, -0.02))
        cls.frames.fix(("table", "arm", cls.table_from_arm), ("table", "fixed_tip", cls.table_from_fixed),
                       ("liver", "attached_tip", cls.organ_from_attached))
        cls.surface = Services().surface()
        cls.contacts = ContactsInbox()

    def setUp(self):
        self.contacts.forget()

    def place(self, table_from_organ, tip_in_organ):
        """The contacts for the organ and the moving tip there, and their stamp."""
        tip_in_arm = self.table_from_arm.back(table_from_organ(tip_in_organ))
        self.contacts.forget()
        stamp = self.frames.put(("table", "liver", table_from_organ), ("arm", "moving_tip", Pose(tip_in_arm)))
        array = self.contacts.wait_for(lambda array: contact_of(array, "moving").stamp == stamp)
        return array, stamp

    def triangle_with_room(self, height):
        """A triangle over and under whose middle no other is nearer than `height` [m]."""
        for triangle in range(len(self.surface.triangles)):
            middle = self.surface.corners[triangle].mean(axis=0)
            normal = self.surface.normals[triangle]
            distances = [self.surface.distance(middle + side * height * normal) for side in (-1, 1)]
            if np.allclose(distances, height, rtol=1e-9, atol=0):
                return triangle, middle, normal
        raise AssertionError("there is no such triangle")

    def test_a_tip_over_and_under_the_middle_of_a_triangle_is_as_far_as_it_was_lifted(self):
        height = 0.001
        triangle, middle, normal = self.triangle_with_room(height)
        for distance in (height, -height):
            array, _ = self.place(Pose(), middle + distance * normal)
            contact = contact_of(array, "moving")
            self.assertEqual(contact.nearest.triangle, triangle)
            self.assertEqual(contact.nearest.feature, NearestTriangle.FACE)
            np.testing.assert_allclose(contact.nearest.barycentric, [1 / 3] * 3, atol=1e-9)
            np.testing.assert_allclose(coordinates(contact.nearest.point), middle, atol=1e-12)
            np.testing.assert_allclose(coordinates(contact.nearest.normal), normal, atol=1e-9)
            self.assertAlmostEqual(contact.nearest.distance, distance, delta=1e-12)
            self.assertEqual(contact.colliding, distance < 0)
            self.assertTrue(contact.colliding_certain)

    def check_contact(self, contact, tip_in_table, table_from_organ):
        tip_in_organ = table_from_organ.back(tip_in_table)
        truth = self.surface.signed_distance(tip_in_organ)
        self.assertEqual((contact.organ, contact.status, contact.mesh_version), ("liver", Contact.OK, 1))
        check_nearest(self, contact.nearest, tip_in_organ, self.surface, truth, table_from_organ)
        np.testing.assert_allclose(coordinates(contact.instrument_point), tip_in_table, rtol=0, atol=1e-12)
        self.assertEqual(contact.colliding, truth < 0)
        self.assertTrue(contact.colliding_certain)

    def test_contacts_agree_with_brute_force_for_random_poses_of_tip_and_organ(self):
        random = np.random.default_rng(2)
        seen = []
        for tip_in_organ in self.surface.random_points(random, RANDOM_POSES):
            table_from_organ = Pose.random(random)
            array, stamp = self.place(table_from_organ, tip_in_organ)
            self.assertEqual((array.header.frame_id, array.header.stamp), ("table", stamp))
            self.assertGreater(array.computation_time, 0.0)
            moving, fixed, attached = array.contacts
            self.assertEqual([contact.instrument for contact in array.contacts], ["moving", "fixed", "attached"])
            self.check_contact(moving, table_from_organ(tip_in_organ), table_from_organ)
            self.check_contact(fixed, self.table_from_fixed.translation, table_from_organ)
            self.check_contact(attached, table_from_organ(self.organ_from_attached.translation), table_from_organ)
            self.assertEqual((fixed.stamp, attached.stamp), (stamp, rospy.Time()))
            seen.append((moving.nearest.feature, moving.colliding))
        self.assertEqual({feature for feature, _ in seen},
                         {NearestTriangle.FACE, NearestTriangle.EDGE, NearestTriangle.VERTEX})
        self.assertEqual({colliding for _, colliding in seen}, {True, False})

    def test_get_mesh_gives_the_file_s_vertices_and_triangles_in_their_order(self):
        shipped = Surface.shipped()
        answer = Services().get_mesh("liver")
        self.assertTrue(answer.success)
        self.assertEqual((answer.frame_id, answer.mesh_version), ("liver", 1))
        np.testing.assert_array_equal(self.surface.vertices, shipped.vertices)
        np.testing.assert_array_equal(self.surface.triangles, shipped.triangles)

    def test_get_mesh_of_an_unknown_organ_is_refused_by_name(self):
        answer = Services().get_mesh("spleen")
        self.assertFalse(answer.success)
        self.assertIn("spleen", answer.message)

    def test_mesh_info_is_latched_and_true(self):
        (info,) = Inbox("organ_collision/mesh_info", MeshInfoArray).wait_for().meshes
        self.assertEqual((info.organ, info.header.frame_id, info.mesh_version, info.last_action),
                         ("liver", "liver", 1, MeshInfo.LOAD))
        self.assertEqual((info.vertices, info.triangles),
                         (len(self.surface.vertices), len(self.surface.triangles)))
        self.assertEqual((info.degenerate_triangles, info.duplicate_triangles), (0, 0))
        self.assertTrue(info.closed and info.consistently_wound and not info.inverted)
        low, high = self.surface.box()
        np.testing.assert_array_equal([coordinates(info.min), coordinates(info.max)], [low, high])
        self.assertGreaterEqual(info.depth, np.log2(info.triangles))
        self.assertGreaterEqual(info.memory, self.surface.vertices.nbytes)
        self.assertGreater(info.last_duration, 0.0)
        self.assertEqual((info.updates_merged, info.updates_lost), (0, 0))

    def move(self, frequency, seconds):
        """Moves organ and tip so often and so long [Hz, s]; returns the stamps."""
        rate = rospy.Rate(frequency)
        stamps = []
        while len(stamps) < frequency * seconds:
            rate.sleep()
            stamps.append(self.frames.put(("table", "liver", Pose()), ("arm", "moving_tip", Pose())))
        self.contacts.wait_for(lambda array: array.header.stamp == stamps[-1])
        return stamps

    def test_contacts_come_at_the_rate_of_a_tip_at_200_hz(self):
        self.place(Pose(), np.zeros(3))
        self.contacts.forget()
        stamps = self.move(200, 1.0)
        arrays = self.contacts.all()
        elapsed = (stamps[-1] - stamps[0]).to_sec()
        answered = {array.header.stamp for array in arrays} & set(stamps)
        self.assertGreater(len(answered), 0.8 * len(stamps), "on a loaded machine some poses come in one cycle")
        self.assertLessEqual(len(arrays), len(stamps) + elapsed / HEARTBEAT + 2)

    def test_poses_that_come_together_are_all_answered(self):
        self.place(Pose(), np.zeros(3))
        self.contacts.forget()
        stamps = []
        for _ in range(3):
            rospy.sleep(0.2)
            stamps += [self.frames.put(("table", "liver", Pose()), ("arm", "moving_tip", Pose())) for _ in range(50)]
        self.contacts.wait_for(lambda array: array.header.stamp == stamps[-1])
        self.assertEqual(set(stamps) - {array.header.stamp for array in self.contacts.all()}, set())

    def test_contacts_do_not_come_more_often_than_the_scene_s_rate(self):
        slow = ContactsInbox("slow")
        self.move(200, 0.2)
        slow.forget()
        start = rospy.get_time()
        self.move(200, 1.0)
        count, elapsed = len(slow.all()), rospy.get_time() - start
        self.assertLessEqual(count, 20 * elapsed + 1)
        self.assertGreaterEqual(count, 15 * elapsed)

    def seconds_for_heartbeats(self, count):
        start = rospy.get_time()
        self.contacts.collect(count, PATIENCE)
        return rospy.get_time() - start

    def test_contacts_come_ten_times_a_second_when_nothing_moves(self):
        self.assertLess(self.seconds_for_heartbeats(10), 10 * HEARTBEAT * LATE)

    def test_contacts_come_ten_times_a_second_when_only_other_frames_move(self):
        # A little more often than the heartbeat, so that each news comes shortly before the next beat.
        timer = rospy.Timer(rospy.Duration(0.9 * HEARTBEAT),
                            lambda _: self.frames.put(("table", "surgeon", Pose())))
        try:
            self.assertLess(self.seconds_for_heartbeats(20), 20 * HEARTBEAT * LATE)
        finally:
            timer.shutdown()

    def test_a_scene_without_pairs_of_a_kind_has_no_proximities(self):
        topics = [topic for topic, _ in rospy.get_published_topics()]
        self.assertIn("/organ_collision/contacts", topics)
        self.assertNotIn("/organ_collision/proximities", topics)


if __name__ == "__main__":
    run(Contacts)
