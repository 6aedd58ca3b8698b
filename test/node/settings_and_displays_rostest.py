#!/usr/bin/env python3
"""What a person at the console sets and sees: dynamic_reconfigure, /diagnostics, rviz's markers."""
import subprocess
import unittest

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from dynamic_reconfigure.client import Client
from rostest_support import (PATIENCE, ContactsInbox, Frames, Inbox, KeepMoving, Pose, Services, bounds_contain,
                             contact_of, coordinates, run)
from visualization_msgs.msg import Marker, MarkerArray

WORLD_FROM_LIVER = Pose((0.1, -0.2, 0.8), (0.1, 0.2, -0.3, 0.9))
LIFT = 0.001  # [m] that a marker may be drawn above the surface, to be seen
TIPS = 30


class SettingsAndDisplays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.frames = Frames("organ_collision", "greedy")
        cls.frames.fix(("world", "liver", WORLD_FROM_LIVER))
        cls.surface = Services().surface()
        cls.contacts = ContactsInbox()
        cls.tips = cls.surface.random_points(np.random.default_rng(6), TIPS)

    def nearest_of_all_tips(self):
        for tip in self.tips:
            stamp = self.frames.put(("liver", "left_tip", Pose(tip)))
            yield tip, self.contacts.contact("left", lambda contact: contact.stamp == stamp).nearest

    def test_max_leaves_of_one_makes_contacts_greedy_and_zero_exact_again(self):
        client = Client("organ_collision", timeout=PATIENCE)
        for max_leaves, exact in ((1, False), (0, True)):
            self.assertEqual(client.update_configuration({"max_leaves": max_leaves})["max_leaves"], max_leaves)
            widths = []
            for tip, nearest in self.nearest_of_all_tips():
                self.assertTrue(bounds_contain(nearest, self.surface.signed_distance(tip)))
                widths.append(nearest.upper_bound - nearest.lower_bound)
            self.assertEqual(max(widths) == 0.0, exact)

    def test_contacts_are_exact_where_no_more_than_errors_are_allowed(self):
        client = Client("organ_collision", timeout=PATIENCE)
        client.update_configuration({"max_relative_error": 0.5, "max_absolute_error": 0.05})
        try:
            for _, nearest in self.nearest_of_all_tips():
                self.assertEqual(nearest.lower_bound, nearest.upper_bound)
        finally:
            client.update_configuration({"max_relative_error": 0.0, "max_absolute_error": 0.0})

    def test_what_is_no_accuracy_is_refused_and_changes_nothing(self):
        client = Client("greedy", timeout=PATIENCE)
        before = client.get_configuration(PATIENCE)
        for key in ("max_relative_error", "max_absolute_error"):
            self.assertEqual(client.update_configuration({key: float("nan")}), before)
        ContactsInbox("greedy").wait_for()

    def test_dynamic_reconfigure_starts_from_the_scene_s_accuracy(self):
        accuracy = Client("greedy", timeout=PATIENCE).get_configuration(PATIENCE)
        self.assertEqual([accuracy[key] for key in ("max_leaves", "max_relative_error", "max_absolute_error")],
                         [1, 0.25, 0.001])

    def test_diagnostics_warn_of_a_tip_without_a_pose_and_are_content_when_it_comes(self):
        diagnostics = Inbox("/diagnostics", DiagnosticArray)

        def status(level):
            def is_wanted(array):
                return any(each.name.startswith("greedy") and each.level == level for each in array.status)
            array = diagnostics.wait_for(is_wanted)
            return next(each for each in array.status if each.name.startswith("greedy"))

        self.assertIn("late", status(DiagnosticStatus.WARN).message)
        diagnostics.forget()
        with KeepMoving(self.frames, ("liver", "late_tip", Pose())):
            content = status(DiagnosticStatus.OK)
        values = {item.key: item.value for item in content.values}
        self.assertEqual(values["liver mesh version"], "1")
        self.assertEqual(values["liver updates lost"], "0")

    def test_diagnostics_tell_of_a_pose_that_was_refused(self):
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        self.frames.put(("liver", "left_tip", Pose((float("nan"), 0.0, 0.0))))
        diagnostics.wait_for(lambda array: any(
            "complaints about tf: " in each.message and "left_tip" in each.message for each in array.status))

    def triangles_of(self, marker):
        """The marker's points [m], three by three, in the organ's frame."""
        points = np.array([coordinates(point) for point in marker.points])
        if marker.header.frame_id == "world":
            points = WORLD_FROM_LIVER.back(points)
        else:
            self.assertEqual(marker.header.frame_id, "liver")
        return points.reshape(-1, 3, 3)

    def test_markers_show_the_surface_and_the_nearest_triangles_in_yellow_and_green(self):
        left, right = self.surface.box()[1] + 0.01, self.surface.box()[0] - 0.01
        with KeepMoving(self.frames, ("liver", "left_tip", Pose(left)), ("liver", "right_tip", Pose(right))):
            array = self.contacts.wait_for(
                lambda array: all(np.allclose(coordinates(contact_of(array, name).instrument_point),
                                              WORLD_FROM_LIVER(tip))
                                  for name, tip in (("left", left), ("right", right))))
            markers = Inbox("organ_collision/markers", MarkerArray)
            lists = [[marker for marker in each.markers if marker.type == Marker.TRIANGLE_LIST]
                     for each in (markers.wait_for(self.shows_the_surface), markers.wait_for())]
        self.assertTrue(all(marker.frame_locked for marker in lists[0]), "they follow an organ that moves")
        surface = next(marker for marker in lists[0] if len(marker.points) > 3)
        np.testing.assert_allclose(self.triangles_of(surface), self.surface.corners, rtol=0, atol=LIFT)
        lit = {self.colour(marker): marker for marker in lists[0] if len(marker.points) == 3}
        self.assertEqual(set(lit), {"yellow", "green"})
        for colour, name in (("yellow", "left"), ("green", "right")):
            corners = self.surface.corners[contact_of(array, name).nearest.triangle]
            np.testing.assert_allclose(self.triangles_of(lit[colour])[0], corners, rtol=0, atol=LIFT)

    def test_markers_show_the_instruments_where_their_frames_are(self):
        def frames(array):
            return {(each.ns, each.header.frame_id) for each in array.markers if each.ns.startswith("shape_of_")}
        array = Inbox("organ_collision/markers", MarkerArray).wait_for(frames)
        self.assertTrue({("shape_of_left", "left_tip"), ("shape_of_right", "right_tip")} <= frames(array))

    def test_who_starts_to_look_later_is_shown_all_at_once(self):
        first = Inbox("greedy/markers", MarkerArray)
        first.wait_for()
        # A process of its own: here, all who listen share one connection.
        later = subprocess.run(["rostopic", "echo", "-n3", "/greedy/markers"], capture_output=True, text=True,
                               timeout=PATIENCE, check=True).stdout
        self.assertIn(f"action: {Marker.DELETEALL}\n", later)
        self.assertIn("surface_of_", later)

    def test_the_first_markers_take_away_what_a_former_node_has_shown(self):
        markers = Inbox("greedy/markers", MarkerArray)
        first, second = ([each.action for each in array.markers]
                         for array in (markers.wait_for(), markers.wait_for(lambda array: array is not markers.all()[0])))
        self.assertEqual(first[0], Marker.DELETEALL)
        self.assertEqual(set(first[1:]), {Marker.ADD})
        self.assertNotIn(Marker.DELETEALL, second)

    def shows_the_surface(self, array):
        return any(marker.type == Marker.TRIANGLE_LIST and len(marker.points) == 3 * len(self.surface.triangles)
                   for marker in array.markers)

    @staticmethod
    def colour(marker):
        bright = (marker.color.r > 0.7, marker.color.g > 0.7, marker.color.b > 0.7)
        return {(True, True, False): "yellow", (False, True, False): "green"}.get(bright, "another")


if __name__ == "__main__":
    run(SettingsAndDisplays)
