#!/usr/bin/env python3
"""Moves a vertex of the liver by a latched message, and again when somebody besides the node and its test listens."""
import rospy
from rostest_support import wait_until

from organ_collision.msg import MeshUpdate

rospy.init_node("latching_client")
publisher = rospy.Publisher("organ_collision/mesh_update", MeshUpdate, queue_size=1, latch=True)
wait_until(lambda: publisher.get_num_connections() == 1, "the node to listen")
message = MeshUpdate(organ="liver", indices=[0], positions=[0.0, 0.0, 0.0])
message.header.frame_id = "liver"
publisher.publish(message)
print("published", flush=True)
wait_until(lambda: publisher.get_num_connections() == 2, "another to listen")
rospy.sleep(0.5)  # it is told what is latched
publisher.publish(message)
rospy.sleep(0.5)
print("published again", flush=True)
