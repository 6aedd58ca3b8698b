#!/usr/bin/env python3
"""The node under a simulator's clock that stands still, jumps and starts anew."""
import time
import unittest

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log
from rostest_support import ContactsInbox, Frames, Inbox, KeepMoving, Pose, Services, SimulatorClock, contact_of, run, wait_until

from organ_collision.msg import Contact

START = 1000.0  # [s] on the simulator's clock
RECOVERY = 1.0  # [s] of wall time, at most, from the first pose after a jump to the first new answer
QUICK = 1.0  # [s] for a refusal that is decided after a tenth of it
HEARTBEATS = 5  # contacts come 10 times a second whatever the clock does


def is_ok(contact):
    return contact.status == Contact.OK


def moving_of(array):
    return contact_of(array, "moving")


class SimTime(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        log = Inbox("/rosout", Log)
        cls.contacts = ContactsInbox()
        cls.before_any_clock = cls.contacts.collect(HEARTBEATS)
        cls.diagnosed_before_any_clock = Inbox("/diagnostics", DiagnosticArray).wait_for()
        log.wait_for(lambda each: "/clock stands at 0" in each.msg)
        cls.clock = SimulatorClock(START)
        cls.frames = Frames()
        cls.frames.fix(("liver", "fixed_tip", Pose((0.0, 0.0, 0.3))))
        cls.services = Services()

    def setUp(self):
        self.clock.set(START)
        self.check_recovery()

    def tearDown(self):
        self.clock.go_on()

    def check_recovery(self):
        """The tip moves on: the node says so within a second."""
        now = rospy.Time.now()
        self.contacts.forget()
        with KeepMoving(self.frames, ("liver", "moving_tip", Pose((0.0, 0.0, 0.2)))):
            contact = self.contacts.contact("moving", lambda contact: is_ok(contact) and contact.stamp >= now, RECOVERY)
        self.assertLess(abs(contact.age.to_sec()), 0.5)
        self.assertTrue(is_ok(self.contacts.contact("fixed")), "static transforms outlive a jump")

    def test_without_a_clock_there_is_no_pose_and_contacts_say_so(self):
        for array in self.before_any_clock:
            self.assertEqual({contact.status for contact in array.contacts}, {Contact.NO_POSE})

    def test_diagnostics_warn_of_a_clock_that_stands_at_zero(self):
        status, = self.diagnosed_before_any_clock.status
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        self.assertIn("/clock stands at 0", status.message)

    def test_the_node_goes_on_within_a_second_when_time_jumps_back(self):
        for now in (START / 2, 1.0):  # a bag that loops, a simulation that starts anew
            self.clock.set(now)
            self.check_recovery()

    def test_the_node_goes_on_within_a_second_when_time_jumps_forward(self):
        for now in (START + 3.0, 2.0 * START, 1e9):
            self.clock.set(now)
            self.check_recovery()

    def test_a_pose_from_before_the_reset_is_stale_until_there_is_a_new_one(self):
        self.clock.set(1.0)
        self.contacts.forget()
        stale = self.contacts.contact("moving")
        self.assertEqual(stale.status, Contact.STALE)
        self.assertGreater(stale.stamp.to_sec(), START / 2, "it is the last pose that tf told")
        self.check_recovery()

    def test_a_pose_from_before_a_jump_stays_stale_where_the_clock_comes_to_its_stamp_again(self):
        stamp = self.contacts.contact("moving").stamp.to_sec()
        self.clock.set(stamp - 0.5)
        self.contacts.forget()
        wait_until(lambda: rospy.get_time() > stamp + 0.2, "the clock to pass the stamp")
        came_again = [contact for contact in map(moving_of, self.contacts.all()) if contact.age.to_sec() > -0.3]
        self.assertGreater(len(came_again), 2)
        self.assertEqual({contact.status for contact in came_again}, {Contact.STALE})
        self.check_recovery()

    def test_transforms_that_come_after_the_reset_with_stamps_of_before_do_no_harm(self):
        self.clock.set(1.0)
        for _ in range(10):
            self.frames.put(("liver", "moving_tip", Pose()), stamp=rospy.Time(START))
            time.sleep(0.02)
        self.check_recovery()

    def test_one_transform_from_the_future_does_no_harm(self):
        self.frames.put(("liver", "moving_tip", Pose()), stamp=rospy.Time.now() + rospy.Duration(3600.0))
        self.frames.put(("liver", "moving_tip", Pose()), stamp=rospy.Time(2**32 - 1))
        self.check_recovery()

    def test_while_the_clock_stands_still_contacts_and_services_go_on(self):
        self.clock.stand_still()
        self.contacts.collect(HEARTBEATS)
        start = time.monotonic()
        answer = self.services.find([(0.0, 0.0, 0.2)], frame="nowhere")
        self.assertLess(time.monotonic() - start, QUICK)
        self.assertFalse(answer.success)
        self.assertIn("nowhere", answer.message)
        self.assertTrue(self.services.find([(0.0, 0.0, 0.2)]).success)

    def test_diagnostics_go_on_after_time_jumped_back_and_while_it_stands_still(self):
        diagnostics = Inbox("/diagnostics", DiagnosticArray)
        diagnostics.collect(2)
        self.clock.set(1.0)
        self.clock.stand_still()
        diagnostics.collect(3)


if __name__ == "__main__":
    run(SimTime)
