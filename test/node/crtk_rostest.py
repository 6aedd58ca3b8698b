#!/usr/bin/env python3
"""crtk.launch, with two arms that speak CRTK, and the two clients."""
import subprocess
import threading
import unittest

import numpy as np
import roslib.packages
import rospy
from geometry_msgs.msg import PoseStamped
from rosgraph_msgs.msg import Log
from rostest_support import PATIENCE, TOLERANCE, ContactsInbox, Frames, Pose, Services, run, wait_until

from organ_collision.msg import Contact

RADIUS = 0.002  # [m] of examples/crtk.yaml
CLIENT = roslib.packages.find_node("organ_collision", "example_client")[0]


class Crtk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.surface = Services().surface("liver")
        cls.frames = Frames()
        cls.frames.fix(("world", "liver", Pose((0.5, 0.1, 0.2))))
        cls.contacts = ContactsInbox()
        cls.arms = {arm: rospy.Publisher(arm + "/measured_cp", PoseStamped, queue_size=1) for arm in ("PSM1", "PSM2")}
        for publisher in cls.arms.values():
            wait_until(lambda: publisher.get_num_connections() > 0, "the relay")

    def send(self, frame="world", **positions):
        """Poses of the arms, with the same stamp, which is returned."""
        message = PoseStamped()
        message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
        message.pose.orientation.w = 1.0
        for arm, position in positions.items():
            for axis, value in zip("xyz", position):
                setattr(message.pose.position, axis, value)
            self.arms[arm].publish(message)
        return message.header.stamp

    def check(self, frame):
        self.contacts.forget()
        at = {"PSM1": (0.5, 0.1, 0.35), "PSM2": (0.52, 0.1, 0.2)}
        stamp = self.send(frame, **at)
        array = self.contacts.wait_for(lambda array: all(each.stamp == stamp for each in array.contacts))
        for contact, position in zip(array.contacts, at.values()):
            self.assertEqual(contact.status, Contact.OK)
            truth = self.surface.signed_distance(np.array(position) - (0.5, 0.1, 0.2)) - RADIUS
            self.assertAlmostEqual(contact.nearest.distance, truth, delta=TOLERANCE)

    def test_measured_cp_becomes_contacts_of_that_pose_and_time(self):
        self.check("world")

    def test_a_pose_without_a_frame_is_in_the_base(self):
        self.check("")

    def test_the_client_in_python_tells_of_a_contact(self):
        heard = []
        rospy.Subscriber("/rosout", Log, lambda log: heard.append(log.msg) if log.name == "/client" else None)
        stop = threading.Event()

        def send():
            while not stop.wait(0.02):
                self.send(PSM1=(0.52, 0.1, 0.2), PSM2=(0.5, 0.1, 0.5))

        sender = threading.Thread(target=send)
        sender.start()
        try:
            wait_until(lambda: any("psm1 touches liver: triangle" in text for text in heard), "the client's message")
            self.assertFalse([text for text in heard if "refused" in text])
        finally:
            stop.set()
            sender.join()

    def test_the_client_in_cpp_asks_moves_a_vertex_and_asks_again(self):
        done = subprocess.run([CLIENT, "liver", "liver", "0", "0", "0.2"], capture_output=True, text=True,
                              timeout=3 * PATIENCE, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("version 1: triangle", done.stdout)
        self.assertIn("version 2: triangle", done.stdout)
        refused = subprocess.run([CLIENT, "spleen", "liver", "0", "0", "0.2"], capture_output=True, text=True,
                                 timeout=3 * PATIENCE, check=False)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("spleen", refused.stdout + refused.stderr)


if __name__ == "__main__":
    run(Crtk)
