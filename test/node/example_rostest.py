#!/usr/bin/env python3
"""An example: every pair that the scenes of its nodes (~nodes) list is answered, and every answer agrees with itself."""
import unittest

import numpy as np
import rospy
from rostest_support import PATIENCE, TOLERANCE, ContactsInbox, Inbox, coordinates, run, wait_until
from visualization_msgs.msg import MarkerArray

from organ_collision.msg import Contact, ProximityArray

ANSWERED = (Contact.OK, Contact.OUT_OF_RANGE)


def named(first, second):
    """A pair, whatever its order."""
    return frozenset((first, second))


class Example(unittest.TestCase):
    def pairs(self, node):
        """Those of instruments and organs, and all others."""
        wait_until(lambda: rospy.has_param(node + "/scene"), node + "/scene")
        scene = rospy.get_param(node + "/scene")
        organs = {organ["name"] for organ in scene["organs"]}
        every = [named(instrument["name"], organ) for instrument in scene["instruments"] for organ in organs]
        pairs = [named(*pair) for pair in scene["pairs"]] if "pairs" in scene else every
        return ({pair for pair in pairs if len(pair & organs) == 1}, {pair for pair in pairs if len(pair & organs) != 1})

    def check(self, status, distance, first, second):
        if status == Contact.OK:
            gap = np.linalg.norm(coordinates(second) - coordinates(first))
            self.assertAlmostEqual(abs(distance), gap, delta=TOLERANCE)

    def test_all_pairs_are_answered(self):
        for node in rospy.get_param("~nodes", ["organ_collision"]):
            contacts, others = self.pairs(node)
            self.assertTrue(contacts)
            array = ContactsInbox(node).wait_for(lambda array: all(each.status in ANSWERED for each in array.contacts))
            self.assertEqual({named(each.instrument, each.organ) for each in array.contacts}, contacts)
            for each in array.contacts:
                if each.nearest.distance > 0:  # inside, an instrument's point may be beside the nearest
                    self.check(each.status, each.nearest.distance, each.instrument_point, each.nearest.point)
            if not others:
                continue
            array = Inbox(node + "/proximities", ProximityArray).wait_for(
                lambda array: all(each.status in ANSWERED for each in array.proximities))
            self.assertEqual({named(each.first, each.second) for each in array.proximities}, others)
            for each in array.proximities:
                self.check(each.status, each.distance, each.point_on_first, each.point_on_second)
            if any(np.isfinite(each.distance) for each in array.proximities):
                Inbox(node + "/markers", MarkerArray).wait_for(
                    lambda array: any(each.ns == "proximity" for each in array.markers))

    def test_the_instruments_move(self):
        for node in rospy.get_param("~nodes", ["organ_collision"]):
            inbox = ContactsInbox(node)

            def points():
                array = inbox.wait_for(lambda array: all(each.status in ANSWERED for each in array.contacts))
                return np.concatenate([coordinates(each.instrument_point) for each in array.contacts])

            start = points()
            inbox.forget()
            wait_until(lambda: inbox.forget() or np.linalg.norm(points() - start) > 0.001, "1 mm of motion", PATIENCE)


if __name__ == "__main__":
    run(Example)
