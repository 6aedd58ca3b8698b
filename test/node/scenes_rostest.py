#!/usr/bin/env python3
"""Instruments of every shape, pairs of every kind, and the triangles around a point, against brute force."""
import unittest

import numpy as np
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from rostest_support import PATIENCE, TOLERANCE, Frames, Inbox, ContactsInbox, Pose, Services, coordinates, run

from organ_collision.msg import Contact, MeshInfoArray, ProximityArray

BALL, SHAFT = 0.01, 0.005  # [m] the radii of scenes.test
AXIS = np.linspace(0, 0.1, 2001)[:, None] * [0, 0, 1]  # [m] points of the shaft's axis, in its frame
STEP = 0.1 / 2000  # [m] between them: the least distance of them is at most half of it too far


class Scenes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services()
        cls.liver, cls.gallbladder = cls.services.surface("liver"), cls.services.surface("gallbladder")
        cls.frames = Frames()
        cls.contacts, cls.proximities = ContactsInbox(), Inbox("organ_collision/proximities", ProximityArray)

    def put(self, **poses):
        """All frames at once; the contacts and the proximities of just these poses."""
        at = {"ball": Pose(), "shaft": Pose(), "jaw": Pose((0, 0, 0.2)), "gallbladder": Pose((0, 0, -0.2)), **poses}
        self.contacts.forget()
        self.proximities.forget()
        stamp = self.frames.put(*[("liver", frame, pose) for frame, pose in at.items()])
        contacts = self.contacts.wait_for(lambda array: all(each.stamp == stamp for each in array.contacts))
        proximities = self.proximities.wait_for(lambda array: all(each.stamp == stamp for each in array.proximities))
        return ({each.instrument: each for each in contacts.contacts},
                {(each.first, each.second): each for each in proximities.proximities})

    def test_a_sphere_s_distance_is_its_centre_s_less_the_radius(self):
        for point in self.liver.random_points(np.random.default_rng(1), 20):
            contact = self.put(ball=Pose(point))[0]["ball"]
            expected = self.liver.signed_distance(point) - BALL
            self.assertAlmostEqual(contact.nearest.distance, expected, delta=TOLERANCE)
            self.assertEqual(contact.colliding, expected <= 0)
            self.assertTrue(contact.colliding_certain)
            on_ball = coordinates(contact.instrument_point)
            self.assertAlmostEqual(np.linalg.norm(on_ball - point), BALL, delta=TOLERANCE)
            self.assertAlmostEqual(np.linalg.norm(on_ball - coordinates(contact.nearest.point)), abs(expected),
                                   delta=TOLERANCE)

    def test_a_capsule_s_distance_is_its_axis_s_less_the_radius(self):
        random = np.random.default_rng(2)
        for point in self.liver.random_points(random, 5):
            pose = Pose(point, random.normal(size=4))
            contact = self.put(shaft=pose)[0]["shaft"]
            along = pose(AXIS[::20])
            distances = np.array([self.liver.distance(each) for each in along])
            inside = {self.liver.contains(along[i]) for i in range(0, len(along), 10)}
            if len(inside) > 1:  # the axis crosses the surface
                self.assertAlmostEqual(contact.nearest.distance, -SHAFT, delta=TOLERANCE)
                continue
            expected = distances.min() * (-1 if True in inside else 1) - SHAFT
            self.assertAlmostEqual(contact.nearest.distance, expected, delta=20 * STEP)

    def test_a_mesh_far_above_is_as_far_as_its_nearest_corner_or_nearer(self):
        jaw = self.put()[0]["jaw"]
        self.assertEqual(jaw.status, Contact.OK)
        tip = coordinates(jaw.instrument_point)
        self.assertAlmostEqual(self.liver.distance(tip), jaw.nearest.distance, delta=TOLERANCE)
        self.assertLess(jaw.nearest.distance, 0.2)
        self.assertFalse(jaw.colliding)
        self.assertTrue(self.put(jaw=Pose())[0]["jaw"].colliding)

    def test_two_instruments_tell_their_distance_on_proximities(self):
        for height in (0.2, 0.11, 0.102):
            proximity = self.put(ball=Pose((0.003, 0, height)))[1]["shaft", "ball"]
            expected = np.hypot(0.003, height - 0.1) - BALL - SHAFT
            self.assertAlmostEqual(proximity.distance, expected, delta=TOLERANCE)
            self.assertEqual(proximity.colliding, expected <= 0)
            first, second = coordinates(proximity.point_on_first), coordinates(proximity.point_on_second)
            np.testing.assert_allclose(second - first, expected * coordinates(proximity.normal), rtol=0, atol=TOLERANCE)
            self.assertEqual((proximity.triangle_of_first, proximity.triangle_of_second), (-1, -1))

    def test_a_mesh_instrument_names_its_triangle(self):
        proximity = self.put(ball=Pose((0, 0, 0.25)))[1]["jaw", "ball"]
        self.assertGreaterEqual(proximity.triangle_of_first, 0)
        self.assertEqual(proximity.triangle_of_second, -1)
        self.assertAlmostEqual(proximity.distance, 0.05 - BALL, delta=2e-4)  # the jaw's tip is rounded off

    def test_two_organs_tell_their_distance_on_proximities(self):
        proximity = self.put(gallbladder=Pose((0, -0.02, -0.12)))[1]["gallbladder", "liver"]
        first, second = coordinates(proximity.point_on_first), coordinates(proximity.point_on_second)
        self.assertAlmostEqual(np.linalg.norm(second - first), proximity.distance, delta=TOLERANCE)
        self.assertAlmostEqual(self.liver.distance(first), proximity.distance, delta=TOLERANCE)
        corners = min(self.liver.distance(each + [0, -0.02, -0.12]) for each in self.gallbladder.vertices)
        self.assertLessEqual(proximity.distance, corners + TOLERANCE)
        self.assertGreater(proximity.distance, corners - 0.005)  # [m] more than the faces bulge between the corners
        self.assertTrue(self.put(gallbladder=Pose())[1]["gallbladder", "liver"].colliding)

    def test_what_is_too_far_is_out_of_range_with_its_proven_bound(self):
        contacts, proximities = self.put(ball=Pose((0, 0, 1.0)))
        self.assertEqual(contacts["ball"].status, Contact.OUT_OF_RANGE)
        self.assertEqual(contacts["ball"].nearest.distance, np.inf)
        truth = self.liver.distance(np.array([0, 0, 1.0])) - BALL
        self.assertGreater(contacts["ball"].nearest.lower_bound, 0.3)
        self.assertLessEqual(contacts["ball"].nearest.lower_bound, truth)
        far = proximities["shaft", "ball"]
        self.assertEqual((far.status, far.distance, far.colliding), (Contact.OUT_OF_RANGE, np.inf, False))
        self.assertAlmostEqual(far.lower_bound, 0.9 - BALL - SHAFT, delta=TOLERANCE)

    def test_mesh_info_tells_for_whom_an_organ_was_built(self):
        info = rospy.wait_for_message("organ_collision/mesh_info", MeshInfoArray, PATIENCE)
        self.assertEqual([(mesh.organ, mesh.reason) for mesh in info.meshes],
                         [("liver", "loaded for ball, shaft, jaw, gallbladder"), ("gallbladder", "loaded for liver")])
        for mesh in info.meshes:
            self.assertTrue(rospy.Time() < mesh.header.stamp <= rospy.Time.now())

    def test_triangles_within_a_radius_are_all_of_them_nearest_first(self):
        point = self.liver.vertices[123] * 1.02
        answer = self.services.find_within(point, 0.01)
        self.assertTrue(answer.success and answer.complete, answer.message)
        self.assertEqual(answer.mesh_version, 1)
        distances = np.array([type(self.liver)(self.liver.vertices, [corners]).distance(point)
                              for corners in self.liver.triangles])
        self.assertEqual(set(answer.triangles), set(np.flatnonzero(distances <= 0.01)))
        np.testing.assert_allclose(answer.distances, np.sort(distances)[:len(answer.distances)], rtol=0,
                                   atol=TOLERANCE)
        some = self.services.find_within(point, 0.01, max_results=3)
        self.assertEqual(some.triangles, answer.triangles[:3])
        self.assertFalse(some.complete)

    def test_triangles_within_refuses_what_means_nothing(self):
        origin = (0.0, 0.0, 0.0)
        for point, radius, word in ((origin, -1.0, "radius"), (origin, np.nan, "radius"),
                                    ((0.0, 0.0, np.nan), 1.0, "point")):
            answer = self.services.find_within(point, radius)
            self.assertFalse(answer.success)
            self.assertIn(word, answer.message)
        self.assertIn("spleen", self.services.find_within(origin, 1.0, organ="spleen").message)

    def test_triangles_within_a_radius_of_a_point_in_another_frame_are_the_same(self):
        point, at = self.liver.vertices[123] * 1.02, Pose((0.02, -0.01, 0.03), (0.1, 0.2, -0.3, 0.9))
        self.put(ball=at)
        answer = self.services.find_within(at.back(point), 0.01, frame="ball")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(set(answer.triangles), set(self.services.find_within(point, 0.01).triangles))

    def test_the_accuracy_that_is_set_is_that_of_proximities_too(self):
        client, pair = Client("organ_collision", timeout=PATIENCE), ("gallbladder", "liver")
        exact = self.put()[1][pair]
        self.assertEqual(exact.upper_bound, exact.lower_bound)
        self.addCleanup(client.update_configuration, {"max_leaves": 0})
        client.update_configuration({"max_leaves": 1})
        rough = self.put()[1][pair]
        self.assertGreater(rough.upper_bound, rough.lower_bound)

    def test_diagnostics_tell_what_is_wrong_with_proximities(self):
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        self.put()  # once: soon these poses are old
        diagnostics.wait_for(lambda array: any("shaft to ball: " in status.message for status in array.status))


if __name__ == "__main__":
    run(Scenes)
