#!/usr/bin/env python3
"""A node that is told of poses faster than it can answer them."""
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray
from rostest_support import ContactsInbox, Frames, Inbox, KeepMoving, Pose, contact_of, run

from organ_collision.msg import Contact

SECONDS = 4.0
RATE = 400.0  # [1/s] of poses: a hundred that wait would be stale


class Overload(unittest.TestCase):
    def test_contacts_come_more_seldom_but_not_late(self):
        frames, contacts, diagnostics = Frames(), ContactsInbox(), Inbox("/diagnostics", DiagnosticArray)
        tips = ("moving_tip", "hull", "other", "third", "fourth", "fifth")
        poses = [("liver", tip, Pose([0.1 * i, 0.02, 0.2])) for i, tip in enumerate(tips)]
        with KeepMoving(frames, *poses, rate=RATE) as mover:
            time.sleep(SECONDS)
            told = [contact_of(array, "moving") for array in contacts.all()]
        if len(told) > 0.9 * mover.sent:
            self.skipTest("this machine answers them all")
        later = told[len(told) // 2:]
        stale = sum(contact.status != Contact.OK for contact in later)
        diagnostics.wait_for(lambda array: any("cannot keep up" in status.message for status in array.status))
        self.assertLess(stale, 0.75 * len(later), "nearly half are older than 0.1 s if poses are left out after 0.2 s")


if __name__ == "__main__":
    run(Overload)
