#!/usr/bin/env python3
"""What a simulator does whose organ deforms: sends all vertices, in the order of the mesh, 60 times a second. This one lets
the organ breathe around the shape that it finds; a simulator has one of its own.

rosrun organ_collision stream.py [_organ:=liver] [_node:=organ_collision]
"""
import math

import numpy as np
import rospy

from organ_collision.msg import MeshUpdate
from organ_collision.srv import GetMesh

PERIOD = 4.0  # [s] of a breath
HEIGHT = 0.005  # [m]


def main():
    node = str(rospy.get_param("~node", "organ_collision"))
    update = MeshUpdate(organ=str(rospy.get_param("~organ", "")))  # may be empty if there is one
    get_mesh = rospy.ServiceProxy(node + "/get_mesh", GetMesh)
    rospy.loginfo("waiting for %s", get_mesh.resolved_name)
    get_mesh.wait_for_service()
    mesh = get_mesh(organ=update.organ)
    if not mesh.success:
        raise SystemExit(mesh.message)
    rest = np.array([(vertex.x, vertex.y, vertex.z) for vertex in mesh.mesh.vertices])
    update.header.frame_id = mesh.frame_id
    publisher = rospy.Publisher(node + "/mesh_update", MeshUpdate, queue_size=1)
    rate = rospy.Rate(60, reset=True)  # and go on where a simulation starts anew
    while not rospy.is_shutdown():
        breath = math.sin(2 * math.pi * rospy.get_time() / PERIOD)
        update.positions = (rest + (0, 0, HEIGHT * breath)).astype(np.float32).ravel()
        publisher.publish(update)
        rate.sleep()


if __name__ == "__main__":
    rospy.init_node("stream")
    try:
        main()
    except rospy.ROSInterruptException:  # ended while it waits
        pass
