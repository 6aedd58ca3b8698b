#!/usr/bin/env python3
"""The node when it is killed, when it is told to end, and when its master goes and comes back."""
import contextlib
import fcntl
import mmap
import os
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest
import xmlrpc.server

import numpy as np
import rospkg
import rospy
import yaml
from own_master import NODE, Master, running
from rostest_support import PATIENCE, run, wait_until

LONGEST_END = 1.0  # [s] from SIGINT to the end of the process
LONGEST_START = 2.0  # [s] from the start of a process to its first answer
LONGEST_SILENCE = 2.5  # [s] before a tip that is missing is complained of
LONGEST_ABSENCE = 3.0  # [s] from a master's return until it knows the node: asked once a second
SCENE = {"organs": [{"name": "liver", "frame": "liver", "mesh": "package://organ_collision/meshes/liver.obj"}],
         "instruments": [{"name": "left", "frame": "left_tip"}]}
TIP = "{header: {frame_id: liver}, child_frame_id: left_tip, transform: {rotation: {w: 1.0}}}"
WHAT_WAITS = (b"left to liver", b"already", b"nowhere")  # for the console
PROBE = "{header: {frame_id: liver}, points: [{x: 0.0, y: 0.0, z: 0.2}]}"


def times(pid):
    """[s] When the process was started, counted from the machine's start, and the processor's time it has had."""
    with open(f"/proc/{pid}/stat") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    user, system, start = (int(fields[i]) / os.sysconf("SC_CLK_TCK") for i in (11, 12, 19))
    return start, user + system


def age(pid):
    """[s] since the process was started."""
    with open("/proc/uptime") as uptime:
        return float(uptime.read().split()[0]) - times(pid)[0]


def computed(process):
    """[s]"""
    return times(process.pid)[1]


def listening_addresses(port):
    """Of IP version 4, in the kernel's hexadecimals."""
    with open("/proc/net/tcp") as table:
        rows = [line.split() for line in table][1:]
    return {row[1].split(":")[0] for row in rows if row[3] == "0A" and int(row[1].split(":")[1], 16) == port}


def heeds_signals(process):
    """From main()'s first line on: before, no program can."""
    with open(f"/proc/{process.pid}/status") as status:
        blocked = next(int(line.split()[1], 16) for line in status if line.startswith("SigBlk"))
    return blocked >> (signal.SIGINT - 1) & 1


def fine_mesh(folder, count):
    """An OBJ of 2 count^2 triangles, which takes a while to read and to build."""
    rows, columns = np.mgrid[0:count + 1, 0:count + 1]
    heights = 0.01 * np.sin(rows) * np.cos(columns)
    corner = 1 + rows[:-1, :-1] * (count + 1) + columns[:-1, :-1]
    first = np.stack([corner, corner + 1, corner + count + 1], axis=-1).reshape(-1, 3)
    second = np.stack([corner + 1, corner + count + 2, corner + count + 1], axis=-1).reshape(-1, 3)
    vertices = np.stack([rows / count, columns / count, heights], axis=-1).reshape(-1, 3)
    path = os.path.join(folder, "fine.obj")
    with open(path, "w") as file:
        np.savetxt(file, vertices, "v %.6f %.6f %.6f")
        np.savetxt(file, np.vstack([first, second]), "f %d %d %d")
    return path


class Faults(unittest.TestCase):
    def setUp(self):
        self.master = Master()
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name

    def check_end(self, process, how=signal.SIGINT):
        """Ctrl-C goes to all processes of the group."""
        start = time.monotonic()
        os.killpg(process.pid, how)
        output, _ = process.communicate(timeout=PATIENCE)
        self.assertLess(time.monotonic() - start, LONGEST_END)
        self.assertEqual(process.returncode, 0, output)
        self.assertNotIn("FATAL", output)

    def repeat_pose(self):
        """A publisher of poses again and again, of which tf takes each only once; the newest comes first."""
        now = int(time.time())
        poses = [f"{{header: {{frame_id: liver, stamp: {{secs: {now - age}}}}}, child_frame_id: spoon, "
                 f"transform: {{rotation: {{w: 1.0}}}}}}" for age in (0, 1, 1)]
        return running("rostopic", "pub", "-r", "100", "/tf", "tf2_msgs/TFMessage",
                       f"{{transforms: [{', '.join(poses)}]}}", env=self.master.environment, stdout=subprocess.DEVNULL)

    def stream(self, frame):
        """An update of a vertex, from a frame."""
        self.master.client("rostopic", "pub", "-1", "/organ_collision/mesh_update", "organ_collision/MeshUpdate",
                           f"{{header: {{frame_id: {frame}}}, indices: [0], positions: [0.0, 0.0, 0.0]}}")

    def test_a_console_that_blocks_keeps_nothing_waiting(self):
        """As after Ctrl-S, or where nobody reads its pipe."""
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        self.addCleanup(os.close, writer)
        fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, mmap.PAGESIZE)
        filler = os.open(f"/proc/self/fd/{writer}", os.O_WRONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, filler)
        with self.master.up():
            self.master.set_scene(SCENE)
            with running(NODE, env=self.master.environment, stdout=writer, stderr=writer):
                wait_until(self.master.is_up, "the node")
                with contextlib.suppress(BlockingIOError):
                    while True:
                        os.write(filler, b"x")
                with self.repeat_pose() as poses:
                    self.stream("nowhere")  # refused, which is logged
                    self.stream("liver")
                    time.sleep(LONGEST_SILENCE)
                    for topic in ("contacts/header", "markers/markers"):
                        self.master.next(topic)
                    wait_until(lambda: self.master.next("mesh_info/meshes[0]/mesh_version") == "2", "the update")
                    self.master.call("find_nearest_triangle", PROBE)
                    self.master.client("rostopic", "echo", "-n", "1", "/diagnostics/header")
                    self.assertIsNone(poses.poll())
                before = os.read(reader, 2 * mmap.PAGESIZE)
                said = bytearray()
                os.set_blocking(reader, False)

                def hear():
                    with contextlib.suppress(BlockingIOError):
                        said.extend(os.read(reader, mmap.PAGESIZE))
                    return all(text in said for text in WHAT_WAITS)

                wait_until(hear, "what waited")
        for text in WHAT_WAITS:
            self.assertNotIn(text, before)

    def test_a_master_that_hangs_is_told_and_keeps_no_contact_waiting(self):
        echo = ("rostopic", "echo", "/diagnostics/status[0]/message")
        with self.master.up() as master:
            self.master.set_scene(SCENE)
            with self.master.node(), running(*echo, env=self.master.environment, stdout=subprocess.PIPE,
                                             text=True) as diagnostics:
                next(line for line in diagnostics.stdout if "contacts flow" in line or "left to liver" in line)
                os.killpg(master.pid, signal.SIGSTOP)
                told = next(line for line in diagnostics.stdout if "the master does not answer for" in line)
                os.killpg(master.pid, signal.SIGCONT)
        self.assertNotIn("no contacts", told)

    # ---- the end

    def test_it_ends_at_once_while_it_waits_for_the_master(self):
        for delay in (0.0, 0.1, 0.5):
            with self.master.node() as process:
                wait_until(lambda: heeds_signals(process), "main()")
                time.sleep(delay)
                self.check_end(process)

    def test_it_ends_at_once_at_any_time_of_its_start(self):
        organs = [dict(SCENE["organs"][0], mesh=fine_mesh(self.folder, 400))]
        with self.master.up():
            self.master.set_scene(dict(SCENE, organs=organs))
            with self.master.node() as process:
                start = time.monotonic()
                wait_until(self.master.is_up, "the node")
                duration = time.monotonic() - start
                self.check_end(process)
            self.assertGreater(duration, 0.2, "else there is nothing to interrupt")
            for delay in np.linspace(0.0, 1.2 * duration, 12):
                with self.master.node() as process:
                    wait_until(lambda: heeds_signals(process), "main()")
                    time.sleep(delay)
                    self.check_end(process)

    def test_it_ends_at_once_in_the_cycle_and_for_every_signal_that_asks_for_it(self):
        with self.master.up():
            self.master.set_scene(SCENE)
            known_after = []
            for how in (signal.SIGINT, signal.SIGTERM, signal.SIGINT):
                with self.master.node() as process:
                    wait_until(lambda: self.master.pid() == process.pid and self.master.is_up(), "the node")
                    self.check_end(process, how)
                known_after.append(self.master.registered())
            self.assertIn(set(), known_after, "it took leave of the master, unless the machine was too busy")

    def test_it_ends_at_once_within_an_update(self):
        organs = [dict(SCENE["organs"][0], mesh=fine_mesh(self.folder, 700))]
        with self.master.up():
            self.master.set_scene(dict(SCENE, organs=organs))
            with self.master.node() as process:
                wait_until(self.master.is_up, "the node")
                rebuilds = [subprocess.Popen(["rosservice", "call", "/organ_collision/update_mesh",
                                              "{header: {frame_id: liver}, mode: 2}"], env=self.master.environment,
                                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(8)]
                idle = computed(process)
                wait_until(lambda: computed(process) > idle + 0.2, "the node to rebuild")
                self.check_end(process)
                for rebuild in rebuilds:
                    rebuild.kill()
                    rebuild.wait()

    def test_it_ends_at_once_when_its_master_is_gone(self):
        with contextlib.ExitStack() as stack:
            with self.master.up():
                self.master.set_scene(SCENE)
                process = stack.enter_context(self.master.node())
                wait_until(self.master.is_up, "the node")
            time.sleep(1.5)
            self.check_end(process)

    # ---- a new start

    def test_killed_under_a_launch_with_respawn_it_serves_again_within_two_seconds_of_its_start(self):
        scene = os.path.join(self.folder, "scene.yaml")
        with open(scene, "w") as file:
            yaml.safe_dump({"scene": SCENE}, file)
        launch = os.path.join(rospkg.RosPack().get_path("organ_collision"), "launch", "organ_collision.launch")
        with self.master.up(), running("roslaunch", launch, f"scene:={scene}", "respawn:=true", "output:=log",
                                       env=self.master.environment, stdout=subprocess.DEVNULL):
            wait_until(self.master.is_up, "the node", 2 * PATIENCE)
            for _ in range(3):
                former = self.master.pid()
                os.kill(former, signal.SIGKILL)
                wait_until(lambda: self.master.pid() not in (0, former) and self.serves(), "the node's return")
                self.assertLess(age(self.master.pid()), LONGEST_START)
                self.assertIn("success: True", self.master.call("find_nearest_triangle", PROBE))

    def serves(self):
        """Its service takes connections: a killed node's is still known to the master."""
        address = self.master.service_address("find_nearest_triangle")
        with contextlib.suppress(OSError):
            if address is not None:
                socket.create_connection(address, 0.1).close()
                return True
        return False

    # ---- who can reach it

    def test_with_localhost_as_its_name_topics_and_services_listen_on_the_loopback_only(self):
        self.master.environment["ROS_HOSTNAME"] = "localhost"
        with self.master.up():
            self.master.set_scene(SCENE)
            with self.master.node():
                wait_until(self.master.is_up, "the node")
                port = self.master.service_address("find_nearest_triangle")[1]
                self.assertEqual(listening_addresses(port), {"0100007F"})

    # ---- the master

    def test_it_ends_and_takes_nothing_back_where_another_node_of_its_name_has_come(self):
        with self.master.up():
            self.master.set_scene(SCENE)
            with self.master.node() as process, xmlrpc.server.SimpleXMLRPCServer(
                    ("localhost", 0), logRequests=False) as other:
                wait_until(self.master.is_up, "the node")
                uri = f"http://localhost:{other.server_address[1]}"
                process.send_signal(signal.SIGSTOP)  # it may ask the master before it hears that it is to end
                self.master.register("/organ_collision", uri)
                time.sleep(1.5)
                process.send_signal(signal.SIGCONT)
                output, _ = process.communicate(timeout=PATIENCE)
                self.assertEqual(process.returncode, 0, output)
                self.assertEqual(self.master.uri_of("/organ_collision"), uri)

    def test_a_master_that_comes_back_knows_the_node_again_and_new_clients_find_it(self):
        with contextlib.ExitStack() as stack:
            with self.master.up():
                self.master.set_scene(SCENE)
                process = stack.enter_context(self.master.node())
                wait_until(self.master.is_up, "the node")
                before = self.master.call("find_nearest_triangle", PROBE)
                known = self.master.registered()
            time.sleep(1.5)
            self.assertIsNone(process.poll(), "it lives without a master")
            for _ in range(2):
                with self.master.up():
                    wait_until(lambda: self.master.registered() == known, "it to know all", LONGEST_ABSENCE)
                    self.assertEqual(self.master.call("find_nearest_triangle", PROBE), before)
                    self.assertEqual(self.master.next("contacts/header/frame_id"), "liver")
                time.sleep(1.5)

    def test_after_the_masters_return_the_node_hears_who_publishes_anew(self):
        with contextlib.ExitStack() as stack:
            with self.master.up():
                self.master.set_scene(SCENE)
                stack.enter_context(self.master.node())
                wait_until(self.master.is_up, "the node")
            with self.master.up(), running(
                    "rostopic", "pub", "-r", "50", "/tf_static", "tf2_msgs/TFMessage",
                    f"transforms: [{TIP}]", env=self.master.environment, stdout=subprocess.DEVNULL):
                wait_until(self.master.is_up, "the master to know the node again")

                wait_until(lambda: self.master.next("contacts/contacts[0]/status") == "0", "the tip's pose")

    def test_after_the_masters_return_the_node_still_hears_who_published_before(self):
        moving = TIP.replace("{frame_id", "{stamp: now, frame_id")
        with contextlib.ExitStack() as stack:
            with self.master.up():
                self.master.set_scene(SCENE)
                stack.enter_context(self.master.node())
                wait_until(self.master.is_up, "the node")
                stack.enter_context(running(
                    "rostopic", "pub", "-s", "-r", "50", "/tf", "tf2_msgs/TFMessage", f"transforms: [{moving}]",
                    env=self.master.environment, stdout=subprocess.DEVNULL))
                wait_until(lambda: self.master.next("contacts/contacts[0]/status") == "0", "the tip's pose")
            with self.master.up():
                wait_until(self.master.is_up, "the master to know the node again")
                last = self.master.next("contacts/contacts[0]/stamp/nsecs")
                wait_until(lambda: self.master.next("contacts/contacts[0]/stamp/nsecs") != last, "a new pose")


if __name__ == "__main__":
    run(Faults)
