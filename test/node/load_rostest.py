#!/usr/bin/env python3
"""The node under ten clients that call as fast as they can, a stream of updates, and a subscriber that does not read.
Lasts LOAD_SECONDS (environment; default 20)."""
import functools
import os
import subprocess
import time
import unittest
import xmlrpc.client

import numpy as np
import rospy
from rostest_support import Frames, Inbox, Pose, Services, run, wait_until

from organ_collision.msg import ContactArray, MeshInfoArray, MeshUpdate
from organ_collision.srv import UpdateMeshRequest

SECONDS = float(os.environ.get("LOAD_SECONDS", 20.0))
CLIENTS = 10
CLIENT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "load_client.py")
LATCHING_CLIENT = os.path.join(os.path.dirname(CLIENT), "latching_client.py")
MOST_POINTS = 100_000  # in one call, as docs/ros_api.md says
STREAM_RATE = 200  # [1/s]
LONGEST_SILENCE = 1.0  # [s] between two contacts, ten times that of the heartbeat
LONGEST_ANSWER = 5.0  # [s] with ten clients, the node and the stream on two processors
CUT_OFF = 1e-3  # of the calls: roscpp now and then closes a connection too early (ros_comm issue 1976)
CHANGES = 50  # of an organ of some MB
GROWTH = 20e6  # [bytes] of memory: so much varies what its threads keep of large batches


def resident_memory(pid):
    """[bytes]"""
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmRSS"))


class Silences:
    """The longest time [s] without contacts."""

    def __init__(self):
        self.longest, self._last = 0.0, time.monotonic()
        self._subscriber = rospy.Subscriber("organ_collision/contacts", ContactArray, self._take, tcp_nodelay=True)

    def _take(self, _):
        now = time.monotonic()
        self.longest, self._last = max(self.longest, now - self._last), now


class Load(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        Frames().fix(("liver", "fixed_tip", Pose((0.0, 0.0, 0.2))))
        cls.services = Services()
        cls.pid = xmlrpc.client.ServerProxy(rospy.get_master().lookupNode("/organ_collision")[2]).getPid("/load")[2]
        cls.surface = cls.services.surface()
        cls.vertices = cls.surface.vertices
        cls.infos = Inbox("organ_collision/mesh_info", MeshInfoArray)
        cls.stream = rospy.Publisher("organ_collision/mesh_update", MeshUpdate, queue_size=10, tcp_nodelay=True)
        wait_until(lambda: cls.stream.get_num_connections() == 1, "the node to hear mesh updates")
        cls.send([0])  # what a publisher loses before the first that comes through, nobody can count
        wait_until(lambda: cls.info().mesh_version == 2, "the first update")

    @classmethod
    def send(cls, indices, organ="liver"):
        """Moves these vertices a little."""
        moved = cls.vertices[indices] + np.random.default_rng().normal(scale=1e-4, size=(len(indices), 3))
        message = MeshUpdate(organ=organ, indices=indices, positions=np.ravel(moved).astype(np.float32))
        message.header.frame_id = "liver"
        cls.stream.publish(message)

    @classmethod
    def info(cls):
        """Of the mesh now."""
        cls.infos.forget()
        cls.services.update(mode=UpdateMeshRequest.REBUILD)
        return cls.infos.wait_for().meshes[0]

    def wait_for_account(self, start, sent):
        """Each of the updates `sent` since `start` is applied, merged or counted as lost."""
        counts = {}

        def is_complete():
            end = self.info()
            for count in ("mesh_version", "updates_merged", "updates_lost"):
                counts[count] = getattr(end, count) - getattr(start, count)
            return sum(counts.values()) == sent

        try:
            wait_until(is_complete, "the account")
        except AssertionError:
            self.fail(f"{sent} updates were sent, but the node tells of {counts}")

    def start(self, *command):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        return process

    def test_ten_clients_and_a_stream_are_served_and_memory_does_not_grow(self):
        start = self.info()
        self.start("rostopic", "echo", "organ_collision/contacts")  # stops reading when its pipe is full
        silences = Silences()
        clients = [self.start(CLIENT, str(seed), str(SECONDS)) for seed in range(CLIENTS)]
        memory, sent = [], 0
        rate = rospy.Rate(STREAM_RATE)
        while any(client.poll() is None for client in clients):
            self.send(np.arange(sent % 100, len(self.vertices), 100))
            sent += 1
            if sent % (STREAM_RATE // 10) == 0:
                self.infos.forget()
                memory.append(resident_memory(self.pid))
            rate.sleep()

        time.sleep(1.0)
        self.send([0])  # lets the node see what was lost just before
        sent += 1
        self.wait_for_account(start, sent)
        results = [client.communicate()[0].rstrip("\n").split(" ", 3) for client in clients]
        calls, slowest = [int(each[0]) for each in results], max(float(each[1]) for each in results)
        cut_off = sum(int(each[2]) for each in results)
        quarters = [quarter.min() for quarter in np.array_split(memory, 4)]
        end = self.info()
        merged, lost = end.updates_merged - start.updates_merged, end.updates_lost - start.updates_lost
        print(f"{sum(calls)} calls in {SECONDS} s, {min(calls)} or more of each client, {cut_off} cut off, the slowest "
              f"{slowest:.3f} s; {sent} updates, {merged} merged, {lost} lost; silence {silences.longest:.3f} s; "
              f"memory {[round(1e-6 * quarter, 1) for quarter in quarters]} MB")
        self.assertEqual([each[3] for each in results], [""] * CLIENTS)
        self.assertGreater(min(calls), SECONDS)
        self.assertLess(slowest, LONGEST_ANSWER)
        self.assertLessEqual(cut_off, CUT_OFF * sum(calls))
        self.assertTrue(0.0 < silences.longest < LONGEST_SILENCE, silences.longest)
        self.assertLess(quarters[3] - quarters[1], GROWTH)

    def growth(self, change):
        """[bytes] of memory by many of the same change, after some."""
        for i in range(10 + CHANGES):
            if i == 10:
                start = resident_memory(self.pid)
            answer = change()
            self.assertTrue(answer.success, answer.message)
        return resident_memory(self.pid) - start

    def test_neither_new_topologies_nor_rebuilds_let_memory_grow(self):
        changes = {"rebuild": {"mode": UpdateMeshRequest.REBUILD},
                   "topology": {"positions": self.vertices, "triangles": self.surface.triangles}}
        for name, fields in changes.items():
            with self.subTest(name):
                self.assertLess(self.growth(functools.partial(self.services.update, **fields)), GROWTH)

    def test_what_is_lost_on_the_way_is_counted(self):
        start = self.info()
        self.send(np.arange(3))
        self.stream.impl.seq += 3  # as if the queue had dropped so many
        self.send(np.arange(3), organ="nobody's")
        self.stream.impl.seq += 4
        self.send(np.arange(3))
        self.wait_for_account(start, 2 + 7)
        self.assertEqual(self.info().updates_lost, start.updates_lost + 7)

    def test_who_hears_what_is_latched_besides_is_no_loss(self):
        start = self.info()
        publisher = self.start(LATCHING_CLIENT)
        self.assertEqual(publisher.stdout.readline(), "published\n")
        listener = rospy.Subscriber("organ_collision/mesh_update", MeshUpdate)  # publishes latched once more, to this
        self.assertEqual(publisher.communicate()[0], "published again\n")
        listener.unregister()
        self.wait_for_account(start, 2)
        self.assertEqual(self.info().updates_lost, start.updates_lost)

    def test_a_batch_above_the_limit_is_refused_with_both_numbers(self):
        answer = self.services.find(np.zeros((MOST_POINTS + 1, 3)))
        self.assertFalse(answer.success)
        self.assertIn(str(MOST_POINTS + 1), answer.message)
        self.assertIn(str(MOST_POINTS), answer.message.replace(str(MOST_POINTS + 1), ""))

    def test_a_batch_of_the_limit_is_answered(self):
        answer = self.services.find(np.zeros((MOST_POINTS, 3)))
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(len(answer.nearest), MOST_POINTS)


if __name__ == "__main__":
    run(Load)
