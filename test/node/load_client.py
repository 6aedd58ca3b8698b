#!/usr/bin/env python3
"""Calls the node's services as fast as it can, in random order. Prints how many, the slowest [s], how many
were cut off on the way, and what was wrong.
Usage: load_client.py SEED SECONDS"""
import sys
import time

import numpy as np
import rospy
from rostest_support import Services

from organ_collision.srv import UpdateMeshRequest


def complaint(services, random):
    """About one call; empty if all is well."""
    kind = random.integers(20)
    if kind == 0:
        answer = services.get_mesh()
    elif kind == 1:
        answer = services.update(mode=UpdateMeshRequest.REBUILD)
    elif kind == 2:
        return "found a spleen" if services.find([(0.0, 0.0, 0.2)], organ="spleen").success else ""
    else:
        points = random.uniform(-0.3, 0.3, (random.integers(1, 3000 if kind == 3 else 20), 3))
        answer = services.find(points)
        if len(answer.nearest) != len(points):
            return f"{len(answer.nearest)} answers to {len(points)} points: {answer.message}"
    return "" if answer.success else answer.message


def main(seed, seconds):
    rospy.init_node("client", anonymous=True)
    services = Services()
    random = np.random.default_rng(int(seed))
    calls, slowest, cut_off, wrong = 0, 0.0, 0, ""
    end = time.monotonic() + float(seconds)
    while time.monotonic() < end:
        start = time.monotonic()
        try:
            wrong = complaint(services, random) or wrong
        except rospy.ServiceException:
            cut_off += 1
        slowest = max(slowest, time.monotonic() - start)
        calls += 1
    print(calls, slowest, cut_off, wrong)


if __name__ == "__main__":
    main(*sys.argv[1:3])
