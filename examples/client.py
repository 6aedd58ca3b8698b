#!/usr/bin/env python3
"""A client: tells each contact that comes within a distance, asks for the triangles around it, and warns where tf is silent.

rosrun organ_collision client.py [_alarm:=0.005] [_node:=organ_collision]
"""
import math
import time

import rospy

from organ_collision.msg import Contact, ContactArray
from organ_collision.srv import FindTrianglesWithin, FindTrianglesWithinRequest


class Client:
    def __init__(self):
        self.alarm = rospy.get_param("~alarm", 0.005)  # [m]
        if not isinstance(self.alarm, (int, float)):
            raise SystemExit(f"client.py: _alarm is {self.alarm!r}, but it must be a number of metres")
        node = str(rospy.get_param("~node", "organ_collision"))
        self.told_at = {}  # when of each pair each thing was told last
        self.find = rospy.ServiceProxy(node + "/find_triangles_within", FindTrianglesWithin)
        rospy.loginfo("waiting for %s", self.find.resolved_name)
        self.find.wait_for_service()
        rospy.Subscriber(node + "/contacts", ContactArray, self.hear, queue_size=1)

    def hear(self, array):
        for contact in array.contacts:
            if contact.status in (Contact.STALE, Contact.NO_POSE):
                if self.is_due(contact, "pose"):
                    rospy.logwarn("%s and %s: no fresh pose on tf", contact.instrument, contact.organ)
            elif contact.nearest.distance < self.alarm and self.is_due(contact, "touch"):
                self.tell(contact, self.around(contact, array.header.frame_id))

    def is_due(self, contact, what):
        """Whether this was not told of the pair within the last second."""
        told, now = (contact.instrument, contact.organ, what), time.monotonic()
        due = now - self.told_at.get(told, -math.inf) > 1.0
        if due:
            self.told_at[told] = now
        return due

    def around(self, contact, frame):
        """How many triangles are within 5 mm of the nearest point."""
        request = FindTrianglesWithinRequest(organ=contact.organ, point=contact.nearest.point, radius=0.005)
        request.header.frame_id = frame  # stamp zero: where the frame is now
        answer = self.find(request)
        return len(answer.triangles) if answer.success else answer.message

    def tell(self, contact, triangles):
        rospy.loginfo("%s %s %s: triangle %d; within 5 mm: %s", contact.instrument,
                      "touches" if contact.colliding else "is near", contact.organ, contact.nearest.triangle, triangles)


if __name__ == "__main__":
    rospy.init_node("client")
    try:
        Client()
        rospy.spin()
    except rospy.ROSInterruptException:  # ended while it waits for the node
        pass
