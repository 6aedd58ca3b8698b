#!/usr/bin/env python3
"""Batches of points in another tf frame than the organ's."""
import math
import unittest

import numpy as np
import rospy
from rostest_support import (TOLERANCE, Frames, KeepMoving, Pose, Services, bounds_contain, check_nearest, run,
                             wait_until)

POINTS = 100
REFUSAL = 1.0  # [s] in which every call is answered


class FindNearestTriangle(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        random = np.random.default_rng(3)
        cls.frames = Frames()
        cls.services = Services()
        cls.organ_from_camera = Pose.random(random)
        cls.frames.fix(("liver", "camera", cls.organ_from_camera))
        cls.surface = cls.services.surface()
        cls.points_in_organ = cls.surface.random_points(random, POINTS)
        cls.points = cls.organ_from_camera.back(cls.points_in_organ)
        cls.truths = [cls.surface.signed_distance(point) for point in cls.points_in_organ]
        cls.camera_from_organ = Pose(cls.organ_from_camera.back(np.zeros(3)),
                                     cls.organ_from_camera.quaternion * [-1, -1, -1, 1])

    def find(self, **accuracy):
        answer = self.services.find(self.points, "camera", **accuracy)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual((len(answer.nearest), answer.header.frame_id, answer.mesh_version), (POINTS, "camera", 1))
        return answer.nearest

    def test_exact_answers_agree_with_brute_force_in_the_request_s_frame(self):
        for query, truth, nearest in zip(self.points_in_organ, self.truths, self.find()):
            check_nearest(self, nearest, query, self.surface, truth, self.camera_from_organ)

    def check_bounds(self, answers):
        for truth, nearest in zip(self.truths, answers):
            self.assertTrue(bounds_contain(nearest, truth), (truth, nearest))
            self.assertIn(nearest.distance, (nearest.lower_bound, nearest.upper_bound))
        return [nearest.upper_bound - nearest.lower_bound for nearest in answers]

    def test_greedy_answers_enclose_the_truth_and_do_not_all_hit_it(self):
        widths = self.check_bounds(self.find(max_leaves=1))
        self.assertGreater(max(widths), 0.0)

    def test_answers_with_a_relative_error_enclose_the_truth_and_keep_to_it(self):
        answers = self.find(max_relative_error=0.5)
        widths = self.check_bounds(answers)
        for truth, nearest in zip(self.truths, answers):
            self.assertLessEqual(abs(nearest.distance), 1.5 * abs(truth) + TOLERANCE)
        self.assertGreater(max(widths), 0.0)

    def test_answers_with_an_absolute_error_enclose_the_truth_and_keep_to_it(self):
        answers = self.find(max_absolute_error=0.01)
        widths = self.check_bounds(answers)
        for truth, nearest in zip(self.truths, answers):
            self.assertLessEqual(abs(nearest.distance), abs(truth) + 0.01 + TOLERANCE)
        self.assertGreater(max(widths), 0.0)

    def test_no_points_are_answered_with_no_triangles(self):
        answer = self.services.find([], "camera")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual((answer.nearest, answer.mesh_version), ([], 1))

    def test_the_only_organ_needs_no_name(self):
        self.assertEqual(self.services.find(self.points, organ="").nearest,
                         self.services.find(self.points, organ="liver").nearest)

    def test_points_are_taken_from_where_their_frame_was_at_the_time_of_the_request(self):
        start = rospy.Time.now()
        middle, end = start + rospy.Duration(0.5), start + rospy.Duration(1.0)
        self.frames.put(("liver", "probe", Pose((0.0, 0.0, 0.2))), stamp=start)
        self.frames.put(("liver", "probe", Pose((0.0, 0.0, 0.4))), stamp=end)
        for stamp, height in ((end, 0.4), (start, 0.2), (middle, 0.3), (rospy.Time(), 0.4)):
            answer = self.services.find([(0, 0, 0)], "probe", stamp=stamp)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(answer.header.stamp, stamp if stamp else end)
            self.assertAlmostEqual(answer.nearest[0].distance, self.surface.distance([0, 0, height]), delta=TOLERANCE)

    def test_a_transform_that_comes_a_little_after_the_question_is_waited_for(self):
        with KeepMoving(self.frames, ("liver", "arm", Pose()), rate=20.0):  # the next comes within half the patience
            wait_until(lambda: self.services.find([(0, 0, 0)], "arm").success, "the first")
            answers = [self.services.find([(0, 0, 0)], "arm", stamp=rospy.Time.now()) for _ in range(10)]
        self.assertGreater(sum(answer.success for answer in answers), 5, "on a loaded machine some may come too late")

    def check_refusal(self, name, points=((0.0, 0.0, 0.0),), **request):
        start = rospy.get_time()
        answer = self.services.find(points, **request)
        elapsed = rospy.get_time() - start
        self.assertFalse(answer.success)
        self.assertIn(name, answer.message)
        self.assertEqual((answer.nearest, answer.mesh_version), ([], 0))
        self.assertEqual((answer.header.frame_id, answer.header.stamp), ("", rospy.Time()))
        self.assertLess(elapsed, REFUSAL)

    def test_an_unknown_frame_is_refused_by_name_within_a_second(self):
        self.check_refusal("nowhere", frame="nowhere")

    def test_a_time_that_tf_does_not_know_is_refused_within_a_second(self):
        self.frames.put(("liver", "wrist", Pose()))
        self.check_refusal("wrist", frame="wrist", stamp=rospy.Time.now() + rospy.Duration(100.0))

    def test_a_missing_frame_is_refused_within_a_second(self):
        self.check_refusal("header.frame_id is empty", frame="")

    def test_a_frame_with_a_leading_slash_is_refused_by_name(self):
        self.check_refusal("header.frame_id is '/nowhere', but a tf frame does not begin with '/'", frame="/nowhere")

    def test_an_unknown_organ_is_refused_by_name(self):
        self.check_refusal("spleen", organ="spleen")

    def test_a_point_that_is_not_finite_is_refused_by_its_number(self):
        for bad in (math.nan, math.inf):
            self.check_refusal("point 1", points=[(0, 0, 0), (0, bad, 0), (0, 0, 0)])

    def test_an_accuracy_that_is_not_a_number_above_zero_is_refused_by_its_field(self):
        for field in ("max_relative_error", "max_absolute_error"):
            for bad in (-1.0, math.nan):
                self.check_refusal(field, **{field: bad})


if __name__ == "__main__":
    run(FindNearestTriangle)
