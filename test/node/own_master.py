"""A master of a test's own, the processes under it, and what a new client says."""
import contextlib
import os
import signal
import socket
import subprocess
import xmlrpc.client

import roslib.packages
from rostest_support import PATIENCE, wait_until

NODE = roslib.packages.find_node("organ_collision", "organ_collision_node")[0]


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def running(*command, **options):
    """A process in a group of its own, which ends with the block."""
    process = subprocess.Popen(command, start_new_session=True, **options)
    try:
        yield process
    finally:
        for how in (signal.SIGINT, signal.SIGKILL):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, how)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(PATIENCE)


class Master:
    """A master of its own: this test's would end the test with it."""

    def __init__(self):
        self.port = free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://localhost:{self.port}")
        self._proxy = xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])

    @contextlib.contextmanager
    def up(self):
        with running("rosmaster", "--core", "-p", str(self.port), env=self.environment) as process:
            wait_until(self.answers, "the master")
            yield process

    def answers(self):
        with contextlib.suppress(OSError):
            return self._proxy.getPid("/test")[0] == 1
        return False

    def set_scene(self, scene, node="organ_collision"):
        self._proxy.setParam("/test", f"/{node}/scene", scene)

    def register(self, node, uri):
        """As a node of this name that is found there would."""
        self._proxy.registerPublisher(node, "/another", "std_msgs/Empty", uri)

    def uri_of(self, node):
        return self._proxy.lookupNode("/test", node)[2]

    def registered(self):
        """What of the node the master knows: kind and name of each topic and service."""
        kinds = self._proxy.getSystemState("/test")[2]
        return {(kind, name) for kind, entries in enumerate(kinds) for name, nodes in entries
                if "/organ_collision" in nodes}

    def is_up(self):
        """At its start the node registers this service last."""
        return (2, "/organ_collision/get_mesh") in self.registered()

    def pid(self):
        """Of the node; 0 if it does not answer."""
        with contextlib.suppress(OSError):
            code, _, uri = self._proxy.lookupNode("/test", "/organ_collision")
            return xmlrpc.client.ServerProxy(uri).getPid("/test")[2] if code == 1 else 0
        return 0

    def service_address(self, service):
        """Host and port; None if the master knows none."""
        code, _, uri = self._proxy.lookupService("/test", f"/organ_collision/{service}")
        if code != 1:
            return None
        host, port = uri.replace("rosrpc://", "").split(":")
        return host, int(port)

    def client(self, *command):
        """What a new client says, which finds the node through the master."""
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=PATIENCE,
                              check=True).stdout

    def call(self, service, request):
        return self.client("rosservice", "call", f"/organ_collision/{service}", request)

    def next(self, field):
        """Of the next message of one of the node's topics."""
        return self.client("rostopic", "echo", "-n", "1", f"/organ_collision/{field}").split()[0].strip('"')

    def node(self):
        return running(NODE, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
