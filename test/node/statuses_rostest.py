#!/usr/bin/env python3
"""What contacts say of tips that are not there yet, not there any more, or far away."""
import time
import unittest

import numpy as np
import rospy
from rostest_support import ContactsInbox, Frames, KeepMoving, Pose, Services, contact_of, run

from organ_collision.msg import Contact

STALE_AFTER = 0.1  # [s] the default
MAX_DISTANCE = 0.05  # [m] of the node near
HEARTBEAT = 0.1  # [s]
RECOVERY = 1.0  # [s] from the first new pose to the first new answer, at most


def is_ok(contact):
    return contact.status == Contact.OK


def is_stale(contact):
    return contact.status == Contact.STALE


class Statuses(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.frames = Frames("organ_collision", "near", "slow")
        cls.surface = Services().surface()
        cls.frames.fix(("liver", "fixed_tip", cls.above(0.03)))
        cls.contacts = ContactsInbox()

    def setUp(self):
        self.contacts.forget()

    @classmethod
    def above(cls, height):
        """So far [m] above the organ's highest vertex, which is then the nearest."""
        highest = cls.surface.vertices[cls.surface.vertices[:, 2].argmax()]
        return Pose(highest + [0.0, 0.0, height])

    def put(self, pose, **stamp):
        return self.frames.put(("liver", "moving_tip", pose), **stamp)

    def answer_to(self, pose):
        stamp = self.put(pose)
        return self.contacts.contact("moving", lambda contact: contact.stamp == stamp)

    def check_that_there_is_no_answer(self, contact, lower_bound):
        self.assertEqual((contact.nearest.distance, contact.nearest.upper_bound), (np.inf, np.inf))
        self.assertEqual(contact.nearest.lower_bound, lower_bound)
        self.assertFalse(contact.colliding)

    def test_a_tip_has_no_pose_before_its_frame_is_there_and_an_answer_within_a_second_after(self):
        for array in self.contacts.collect(5):
            late = contact_of(array, "late")
            self.assertEqual((late.status, late.stamp, late.age), (Contact.NO_POSE, rospy.Time(), rospy.Duration()))
            self.check_that_there_is_no_answer(late, lower_bound=0.0)
        self.contacts.forget()
        with KeepMoving(self.frames, ("liver", "late_tip", self.above(0.02))):
            late = self.contacts.contact("late", is_ok, RECOVERY)
        self.assertAlmostEqual(late.nearest.distance, 0.02, delta=1e-12)

    def test_when_tf_stops_the_last_answer_is_repeated_as_stale_with_its_growing_age(self):
        last = self.answer_to(self.above(0.01))
        self.contacts.forget()
        stale = self.contacts.contact("moving", is_stale)
        later = self.contacts.contact("moving", lambda contact: contact.age > stale.age + rospy.Duration(0.2))
        for contact in (stale, later):
            self.assertEqual(contact.status, Contact.STALE)
            self.assertEqual(contact.stamp, last.stamp)
            self.assertEqual((contact.nearest, contact.instrument_point), (last.nearest, last.instrument_point))
            self.assertGreater(contact.age.to_sec(), STALE_AFTER)

    def test_a_contact_is_stale_exactly_when_its_age_is_over_the_limit(self):
        stamp = self.answer_to(self.above(0.01)).stamp
        self.contacts.contact("moving", lambda contact: contact.stamp == stamp and is_stale(contact))
        contacts = [contact_of(array, "moving") for array in self.contacts.all()]
        contacts = [contact for contact in contacts if contact.stamp == stamp]
        for contact in contacts:
            self.assertEqual(is_stale(contact), contact.age.to_sec() > STALE_AFTER)
        self.assertEqual({is_stale(contact) for contact in contacts}, {False, True})

    def test_contacts_carry_the_stamp_of_the_tip_and_its_age(self):
        for delay, status in ((2.0 * STALE_AFTER, Contact.STALE), (0.2 * STALE_AFTER, Contact.OK)):
            now = rospy.Time.now()
            stamp = self.frames.put(("liver", "delayed_tip", self.above(0.01)), stamp=now - rospy.Duration(delay))
            array = self.contacts.wait_for(lambda array: contact_of(array, "delayed").stamp == stamp)
            contact = contact_of(array, "delayed")
            self.assertEqual(contact.status, status)
            self.assertTrue(now - stamp <= contact.age <= rospy.Time.now() - stamp)
            self.assertEqual(array.header.stamp, max(contact.stamp for contact in array.contacts))

    def test_a_stale_tip_recovers_within_a_second(self):
        self.put(self.above(0.01))
        self.contacts.contact("moving", is_stale)
        self.contacts.forget()
        with KeepMoving(self.frames, ("liver", "moving_tip", self.above(0.025))):
            contact = self.contacts.contact("moving", is_ok, RECOVERY)
        self.assertAlmostEqual(contact.nearest.distance, 0.025, delta=1e-12)

    def test_a_static_tip_is_never_stale(self):
        self.contacts.contact("fixed", is_ok)
        for array in self.contacts.collect(8):  # longer than the limit at ten a second
            fixed = contact_of(array, "fixed")
            self.assertEqual((fixed.status, fixed.stamp, fixed.age), (Contact.OK, rospy.Time(), rospy.Duration()))
            self.assertAlmostEqual(fixed.nearest.distance, 0.03, delta=1e-12)

    def test_a_tip_beyond_the_maximal_distance_is_out_of_range_with_a_proven_lower_bound(self):
        near = ContactsInbox("near")
        for height in (0.9 * MAX_DISTANCE, 1.1 * MAX_DISTANCE, 10 * MAX_DISTANCE):
            near.forget()
            since = rospy.Time.now()
            with KeepMoving(self.frames, ("liver", "moving_tip", self.above(height))):
                contact = near.contact(
                    "moving", lambda contact: contact.stamp >= since and contact.age.to_sec() <= STALE_AFTER)
            if height < MAX_DISTANCE:
                self.assertEqual(contact.status, Contact.OK)
                self.assertAlmostEqual(contact.nearest.distance, height, delta=1e-12)
                continue
            self.assertEqual(contact.status, Contact.OUT_OF_RANGE)
            self.check_that_there_is_no_answer(contact, contact.nearest.lower_bound)
            self.assertGreater(contact.nearest.lower_bound, MAX_DISTANCE)
            self.assertLessEqual(contact.nearest.lower_bound, height + 1e-12)

    def test_a_low_rate_loses_no_frame_whatever_else_tf_tells(self):
        slow, tips = ContactsInbox("slow"), [f"tip_{i}" for i in range(10)]
        for tip in tips:
            self.frames.put(("liver", tip, self.above(0.01)))  # once
            for _ in range(200):  # more than wait here for one of ten cycles a second
                self.frames.put(("liver", "other", Pose()))
                time.sleep(0.0005)
        slow.wait_for(lambda array: all(contact_of(array, tip).status != Contact.NO_POSE for tip in tips))

    def test_a_low_rate_leaves_the_heartbeat_as_it_is(self):
        slow, start = ContactsInbox("slow"), time.monotonic()
        slow.collect(10)
        self.assertLess(time.monotonic() - start, 25 * HEARTBEAT)


if __name__ == "__main__":
    run(Statuses)
