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
from rostest_support import (PATIENCE, TOLERANCE, ContactsInbox, Frames, Inbox, Pose, Services, coordinates, run,
                             wait_until)
from tf2_msgs.msg import TFMessage

from organ_collision.msg import Contact

TOPICS = {"PSM1": "PSM1/measured_cp", "PSM2": "CRTK/psm2/measured_cp"}
CART = Pose((0.3, -0.1, 0.2), (0.1, -0.2, 0.3, 0.9))  # where the arms' base is in the world
RADIUS = 0.002  # [m] of examples/crtk.yaml
CLIENT = roslib.packages.find_node("organ_collision", "example_client")[0]


class Crtk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.surface = Services().surface("liver")
        cls.frames = Frames()
        cls.frames.fix(("world", "liver", Pose((0.5, 0.1, 0.2))), ("world", "cart", CART))
        cls.contacts = ContactsInbox()
        cls.arms = {arm: rospy.Publisher(topic, PoseStamped, queue_size=1) for arm, topic in TOPICS.items()}
        for publisher in cls.arms.values():
            wait_until(lambda: publisher.get_num_connections() > 0, "the relay")

        def is_heard():
            cls.send(PSM1=(0, 0, 0), PSM2=(0, 0, 0))
            return cls.contacts.find(lambda array: all(each.status == Contact.OK for each in array.contacts), 0.1)

        wait_until(is_heard, "the node to hear the relay")

    @classmethod
    def send(cls, frame="world", **positions):
        """Positions of the arms, with the same stamp, which is returned."""
        message = PoseStamped()
        message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
        message.pose.orientation.w = 1.0
        for arm, position in positions.items():
            for axis, value in zip("xyz", position):
                setattr(message.pose.position, axis, value)
            cls.arms[arm].publish(message)
        return message.header.stamp

    def check(self, frame, world_from_frame=Pose()):
        self.contacts.forget()
        at = {"PSM1": (0.5, 0.1, 0.35), "PSM2": (0.52, 0.1, 0.2)}
        stamp = self.send(frame, **{arm: world_from_frame.back(position) for arm, position in at.items()})
        array = self.contacts.wait_for(lambda array: all(each.stamp == stamp for each in array.contacts))
        for contact, position in zip(array.contacts, at.values()):
            self.assertEqual(contact.status, Contact.OK)
            truth = self.surface.signed_distance(np.array(position) - (0.5, 0.1, 0.2)) - RADIUS
            self.assertAlmostEqual(contact.nearest.distance, truth, delta=TOLERANCE)

    def test_measured_cp_becomes_contacts_of_that_pose_and_time(self):
        self.check("world")

    def test_a_pose_without_a_frame_is_in_the_base(self):
        self.check("", CART)

    def test_a_transform_has_the_pose_s_orientation_and_its_frame_without_a_leading_slash(self):
        transforms = Inbox("/tf", TFMessage)
        pose, message = Pose.random(np.random.default_rng(9)), PoseStamped()
        message.header.frame_id, message.header.stamp = "/world", rospy.Time.now()
        for part, values in ((message.pose.position, pose.translation), (message.pose.orientation, pose.quaternion)):
            for axis, value in zip("xyzw", values):
                setattr(part, axis, value)

        def come():
            self.arms["PSM1"].publish(message)
            return [each for array in transforms.all() for each in array.transforms
                    if each.header.stamp == message.header.stamp]

        wait_until(come, "the transform")  # who has just subscribed misses some
        told = come()[0]
        self.assertEqual((told.header.frame_id, told.child_frame_id), ("world", "psm1_tip"))
        np.testing.assert_array_equal(coordinates(told.transform.translation), pose.translation)
        self.assertEqual(told.transform.rotation, message.pose.orientation)

    def test_a_pose_without_a_time_is_of_now(self):
        message = PoseStamped()
        message.header.frame_id, message.pose.orientation.w = "world", 1.0
        before = rospy.Time.now()
        self.contacts.forget()
        self.arms["PSM2"].publish(message)
        self.contacts.contact("psm2", lambda contact: contact.stamp >= before)

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
