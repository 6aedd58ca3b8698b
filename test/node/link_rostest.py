#!/usr/bin/env python3
"""Organs taken from the <collision> of a link in robot_description."""
import unittest

import numpy as np
from rostest_support import Pose, Services, Surface, check_nearest, run

HALF_ANGLES = 0.5 * np.array([0.4, -0.5, 0.6])  # [rad] of the origin in link.urdf: roll, pitch, yaw
POINTS = 50


def quaternion_from_half_angles(half_angles):
    """x y z w of yaw after pitch after roll."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(half_angles), np.sin(half_angles)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy)


class Link(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services()
        cls.shipped = Surface.shipped()

    def check_organ(self, organ, frame, expected):
        """Its vertices, and the answers to random points around it."""
        actual = self.services.surface(organ)
        np.testing.assert_allclose(actual.vertices, expected.vertices, rtol=0, atol=1e-15)
        self.assertEqual(self.services.get_mesh(organ).frame_id, frame)
        points = expected.random_points(np.random.default_rng(7), POINTS)
        answer = self.services.find(points, frame, organ)
        self.assertTrue(answer.success, answer.message)
        for point, nearest in zip(points, answer.nearest):
            check_nearest(self, nearest, point, actual, expected.signed_distance(point))

    def test_scale_and_origin_of_a_link_s_mesh_move_the_answers_accordingly(self):
        link_from_mesh = Pose((0.1, -0.2, 0.3), quaternion_from_half_angles(HALF_ANGLES))
        self.check_organ("small", "small_liver", self.shipped.of(link_from_mesh(0.5 * self.shipped.vertices)))

    def test_a_mirrored_mesh_keeps_its_inside(self):
        vertices = self.shipped.vertices * [-1, 1, 1]
        self.check_organ("mirrored", "mirrored_liver", Surface(vertices, self.shipped.triangles[:, ::-1]))

    def test_with_two_organs_a_question_without_a_name_is_refused_with_the_names(self):
        answer = self.services.find([(0, 0, 0)], "small_liver")
        self.assertFalse(answer.success)
        self.assertIn("small, mirrored", answer.message)


if __name__ == "__main__":
    run(Link)
