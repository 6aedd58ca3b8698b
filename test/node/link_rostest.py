#!/usr/bin/env python3
"""Organs and instruments taken from links of the robot_description of the node's namespace, and meshes with a scale."""
import time
import unittest

import numpy as np
from rostest_support import TOLERANCE, Frames, Inbox, Pose, Services, Surface, check_nearest, run

from organ_collision.msg import ProximityArray

HALF_ANGLES = 0.5 * np.array([0.4, -0.5, 0.6])  # [rad] of the origin in link.urdf: roll, pitch, yaw
POINTS = 50
NODE = "theatre/organ_collision"
BALL, PIECE = 0.002, 0.01  # [m] radii of the ball and of the tool's sphere
PIECE_IN_TOOL = np.array([0.0, 0.0, 0.3])  # [m]
HEARTBEAT = 0.1  # [s]


def quaternion_from_half_angles(half_angles):
    """x y z w of yaw after pitch after roll."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(half_angles), np.sin(half_angles)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy)


class Link(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services(NODE)
        cls.shipped = Surface.shipped()
        cls.frames = Frames(NODE)
        cls.frames.fix(("table", "small_liver", Pose()))
        cls.table_from_tool = Pose((0.3, 0.1, -0.2), (0.1, -0.2, 0.3, 0.9))
        cls.proximities = Inbox(NODE + "/proximities", ProximityArray)

    def proximities_to(self, ball_in_tool):
        """Of every tool, by its name."""
        self.proximities.forget()
        stamp = self.frames.put(("table", "tool", self.table_from_tool),
                                ("table", "ball", Pose(self.table_from_tool(ball_in_tool))))
        array = self.proximities.wait_for(lambda array: all(each.stamp == stamp for each in array.proximities))
        return {each.first: each for each in array.proximities}

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

    def test_a_scale_of_the_scene_moves_the_answers_accordingly(self):
        self.check_organ("large", "large_liver", self.shipped.of(2.0 * self.shipped.vertices))

    def test_every_piece_of_an_instrument_s_link_and_its_mesh_s_scale_tell(self):
        half = self.shipped.of(0.5 * self.shipped.vertices)
        for point in half.vertices[::500] * 1.3:
            tools = self.proximities_to(point)
            for name in ("linked", "scaled"):
                self.assertAlmostEqual(tools[name].distance, half.signed_distance(point) - BALL, delta=TOLERANCE)
                self.assertGreaterEqual(tools[name].triangle_of_first, 0)
        linked = self.proximities_to(PIECE_IN_TOOL + [0.0, 0.0, 0.02])["linked"]
        self.assertAlmostEqual(linked.distance, 0.02 - PIECE - BALL, delta=TOLERANCE)
        self.assertEqual(linked.triangle_of_first, -1)

    def hollow(self, surface):
        """A point outside the surface, but inside its hull."""
        random = np.random.default_rng(8)
        while True:
            point = surface.vertices[random.choice(len(surface.vertices), 2)].mean(axis=0)
            if surface.signed_distance(point) > 2 * BALL:
                return point

    def test_a_convex_instrument_counts_as_its_hull_from_a_link_too(self):
        tools = self.proximities_to(self.hollow(self.shipped.of(0.5 * self.shipped.vertices)))
        for name in ("linked", "scaled"):
            self.assertFalse(tools[name].colliding)
            self.assertTrue(tools[name + "_hull"].colliding)
            self.assertEqual(tools[name + "_hull"].triangle_of_first, -1)

    def test_tools_that_are_in_pairs_with_each_other_only_are_told_of_as_soon_as_they_move(self):
        start = time.monotonic()
        for height in range(20):
            self.proximities_to([0.0, 0.0, 0.4 + 0.001 * height])
        self.assertLess(time.monotonic() - start, 10 * HEARTBEAT)


if __name__ == "__main__":
    run(Link)
