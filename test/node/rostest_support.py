"""What the tests of the running node share: frames, messages to be waited for, and the truth by brute force."""
import os
import threading
import time

import numpy as np
import rospkg
import rospy
import rostest
from geometry_msgs.msg import Point, TransformStamped
from rosgraph_msgs.msg import Clock
from shape_msgs.msg import MeshTriangle
from tf2_msgs.msg import TFMessage

from organ_collision.msg import ContactArray, NearestTriangle
from organ_collision.srv import (FindNearestTriangle, FindNearestTriangleRequest, FindTrianglesWithin,
                                 FindTrianglesWithinRequest, GetMesh, UpdateMesh, UpdateMeshRequest)

PATIENCE = 10.0  # [s] for what is done in a fraction of it: a loaded machine is no failure
TOLERANCE = 1e-12  # [m] rounding of poses and distances of at most a few metres: some hundred ulps of a metre
DIRECTION_TOLERANCE = 1e-9  # of unit vectors made from triangles with edges of millimetres


def run(test_case):
    """The last line of a test's script."""
    name = os.path.splitext(os.path.basename(rospy.myargv()[0]))[0]
    rospy.init_node(name)
    rostest.rosrun("organ_collision", name, test_case)


# ---- geometry

class Pose:
    """Where a frame is in another: called with points of the one, gives them in the other."""

    def __init__(self, translation=(0.0, 0.0, 0.0), quaternion=(0.0, 0.0, 0.0, 1.0)):
        self.translation = np.array(translation, float)
        self.quaternion = np.array(quaternion, float) / np.linalg.norm(quaternion)
        x, y, z, w = self.quaternion
        self.rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                  [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                  [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])

    @staticmethod
    def random(random, reach=0.5):
        return Pose(random.uniform(-reach, reach, 3), random.normal(size=4))

    def __call__(self, points):
        return np.asarray(points) @ self.rotation.T + self.translation

    def back(self, points):
        """From the frame that __call__ leads to."""
        return (np.asarray(points) - self.translation) @ self.rotation


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)


class Surface:
    """Triangles that are asked one by one, all of them: slow, short, and nothing in common with the node."""

    def __init__(self, vertices, triangles):
        self.vertices = np.array(vertices, float)
        self.triangles = np.array(triangles, int)
        self.corners = self.vertices[self.triangles]  # triangle, corner, coordinate
        a, b, c = np.moveaxis(self.corners, 1, 0)
        self.normals = np.cross(b - a, c - a)
        self.normals /= np.linalg.norm(self.normals, axis=1)[:, None]

    @staticmethod
    def shipped():
        """The liver that ships with the package, read from its file."""
        path = os.path.join(rospkg.RosPack().get_path("organ_collision"), "meshes", "liver.obj")
        lines = [line.split() for line in open(path)]
        return Surface([[float(word) for word in words[1:4]] for words in lines if words[:1] == ["v"]],
                       [[int(word) - 1 for word in words[1:4]] for words in lines if words[:1] == ["f"]])

    def of(self, vertices):
        """The same triangles between other vertices."""
        return Surface(vertices, self.triangles)

    def box(self):
        used = self.corners.reshape(-1, 3)
        return used.min(axis=0), used.max(axis=0)

    def random_points(self, random, count):
        """In and around the surface."""
        low, high = self.box()
        return random.uniform(low - 0.3 * (high - low), high + 0.3 * (high - low), (count, 3))

    def distance(self, point):
        """To the nearest triangle, never negative."""
        squared = np.full(len(self.triangles), np.inf)
        over_face = np.full(len(self.triangles), True)
        for i in range(3):
            start, along = self.corners[:, i], self.corners[:, (i + 1) % 3] - self.corners[:, i]
            to_point = point - start
            part = np.clip(dot(to_point, along) / dot(along, along), 0.0, 1.0)
            gap = to_point - part[:, None] * along
            squared = np.minimum(squared, dot(gap, gap))
            over_face &= dot(np.cross(along, to_point), self.normals) >= 0.0
        height = dot(point - self.corners[:, 0], self.normals)
        return np.sqrt(np.where(over_face, height * height, squared).min())

    def contains(self, point):
        """By the solid angle under which the surface is seen (van Oosterom and Strackee, 1983)."""
        a, b, c = np.moveaxis(self.corners - point, 1, 0)
        lengths = [np.linalg.norm(corner, axis=1) for corner in (a, b, c)]
        volume = dot(a, np.cross(b, c))
        others = (lengths[0] * lengths[1] * lengths[2] + dot(a, b) * lengths[2] + dot(b, c) * lengths[0]
                  + dot(c, a) * lengths[1])
        return np.sum(2.0 * np.arctan2(volume, others)) > 2.0 * np.pi

    def signed_distance(self, point):
        """Negative inside."""
        return self.distance(point) * (-1.0 if self.contains(point) else 1.0)

    def pseudonormal(self, triangle, weights):
        """Of the face, edge or vertex of `triangle` that the weights name: by the angles of the faces around."""
        feature = self.triangles[triangle][np.asarray(weights) != 0.0]
        around = np.flatnonzero(np.isin(self.triangles, feature).sum(axis=1) == len(feature))
        if len(feature) > 1:
            total = self.normals[around].sum(axis=0)
        else:
            total = sum(self._angle(i, feature[0]) * self.normals[i] for i in around)
        return total / np.linalg.norm(total)

    def _angle(self, triangle, vertex):
        k = list(self.triangles[triangle]).index(vertex)
        corners = self.corners[triangle]
        first, second = corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]
        return np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)


def bounds_contain(nearest, truth):
    """`truth`: negative inside; without a proven sign the bounds are of its size."""
    true_distance = truth if nearest.distance_signed else abs(truth)
    return nearest.lower_bound - TOLERANCE <= true_distance <= nearest.upper_bound + TOLERANCE


def check_nearest(test, nearest, query, surface, truth, frame_from_organ=Pose()):
    """All that an exact answer of the node to `query` [m, in the organ's frame] claims; `truth` as above."""
    test.assertTrue(nearest.distance_signed)
    test.assertAlmostEqual(nearest.distance, truth, delta=TOLERANCE)
    test.assertEqual(nearest.lower_bound, nearest.distance)
    test.assertEqual(nearest.upper_bound, nearest.distance)

    weights = np.array(nearest.barycentric)
    point = weights @ surface.corners[nearest.triangle]
    test.assertGreaterEqual(weights.min(), 0.0)
    test.assertAlmostEqual(weights.sum(), 1.0, delta=TOLERANCE)
    test.assertAlmostEqual(np.linalg.norm(point - query), abs(truth), delta=TOLERANCE)
    np.testing.assert_allclose(coordinates(nearest.point), frame_from_organ(point), rtol=0, atol=TOLERANCE)
    features = {1: NearestTriangle.VERTEX, 2: NearestTriangle.EDGE, 3: NearestTriangle.FACE}
    test.assertEqual(nearest.feature, features[np.count_nonzero(weights)])

    outward = surface.pseudonormal(nearest.triangle, weights)
    np.testing.assert_allclose(coordinates(nearest.normal), frame_from_organ.rotation @ outward, rtol=0,
                               atol=DIRECTION_TOLERANCE)
    test.assertGreater(((query - point) @ outward) * truth, 0.0)


# ---- messages

def coordinates(message):
    """Of a Point or Vector3."""
    return np.array([message.x, message.y, message.z])


def points_message(points):
    return [Point(*point) for point in points]


class Inbox:
    """The messages of a topic, in order, to be waited for."""

    def __init__(self, topic, kind):
        self._messages = []
        self._came = threading.Condition()
        self._topic = topic
        self._subscriber = rospy.Subscriber(topic, kind, self._take, tcp_nodelay=True)
        wait_until(lambda: self._subscriber.get_num_connections() > 0, f"a publisher of {topic}")

    def _take(self, message):
        with self._came:
            self._messages.append(message)
            self._came.notify_all()

    def forget(self):
        """What came before is not looked at any more."""
        with self._came:
            self._messages.clear()

    def all(self):
        """What has come since forget()."""
        with self._came:
            return list(self._messages)

    def wait_for(self, is_wanted=lambda message: True, seconds=PATIENCE):
        """The first message since forget() that is wanted."""
        deadline = time.monotonic() + seconds
        seen = 0
        with self._came:
            while True:
                while seen < len(self._messages):
                    if is_wanted(self._messages[seen]):
                        return self._messages[seen]
                    seen += 1
                rest = deadline - time.monotonic()
                if rest <= 0.0:
                    raise AssertionError(f"no such message on {self._topic} within {seconds} s; the last of "
                                         f"{seen}: {self._messages[-1] if seen else 'none came'}")
                self._came.wait(rest)

    def collect(self, count, seconds=PATIENCE):
        """The next `count` messages from now on."""
        self.forget()
        self.wait_for(lambda _: len(self._messages) >= count, seconds)
        return self.all()[:count]


class ContactsInbox(Inbox):
    """What a node says of its instruments."""

    def __init__(self, node="organ_collision"):
        super().__init__(node + "/contacts", ContactArray)

    def find(self, is_wanted, seconds):
        """The first message since forget() that is wanted, or None if it does not come in time."""
        try:
            return self.wait_for(is_wanted, seconds)
        except AssertionError:
            return None

    def contact(self, instrument, is_wanted=lambda contact: True, seconds=PATIENCE):
        """The instrument's first contact since forget() that is wanted, in a scene with one organ."""
        array = self.wait_for(lambda array: is_wanted(contact_of(array, instrument)), seconds)
        return contact_of(array, instrument)


def contact_of(array, instrument):
    return next(contact for contact in array.contacts if contact.instrument == instrument)


def wait_until(is_true, what, seconds=PATIENCE):
    """For what no message tells."""
    deadline = time.monotonic() + seconds
    while not is_true():
        if time.monotonic() > deadline:
            raise AssertionError(f"waited {seconds} s in vain for {what}")
        time.sleep(0.005)


class Frames:
    """Publishes tf, to nodes that are listening."""

    def __init__(self, *nodes):
        for node in nodes or ["organ_collision"]:
            rospy.wait_for_service(node + "/get_mesh", PATIENCE)
        self._moving = rospy.Publisher("/tf", TFMessage, queue_size=10000, tcp_nodelay=True)
        self._static = rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)
        for publisher in (self._moving, self._static):
            wait_until(lambda: publisher.get_num_connections() >= max(1, len(nodes)), "listeners to tf")

    def fix(self, *poses):
        """All static transforms, once: a parent, a child, and where the child is."""
        self._static.publish([self._transform(rospy.Time(), *pose) for pose in poses])

    def put(self, *poses, stamp=None):
        """The same for frames that move; returns the stamp given to them."""
        stamp = stamp or rospy.Time.now()
        self._moving.publish([self._transform(stamp, *pose) for pose in poses])
        return stamp

    @staticmethod
    def _transform(stamp, parent, child, pose):
        message = TransformStamped()
        message.header.stamp, message.header.frame_id, message.child_frame_id = stamp, parent, child
        for axis, value in zip("xyz", pose.translation):
            setattr(message.transform.translation, axis, value)
        for axis, value in zip("xyzw", pose.quaternion):
            setattr(message.transform.rotation, axis, value)
        return message


class KeepMoving:
    """Sends the same poses again and again, with new stamps, while the block lasts."""

    def __init__(self, frames, *poses, rate=50.0):
        self._frames, self._poses, self._period = frames, poses, 1.0 / rate
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._send)
        self.sent = 0

    def _send(self):
        while not self._stop.is_set():
            self._frames.put(*self._poses)
            self.sent += 1
            self._stop.wait(self._period)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()


class SimulatorClock:
    """Publishes /clock 100 times a second."""

    def __init__(self, start):
        self._publisher = rospy.Publisher("/clock", Clock, queue_size=10)
        self._now, self._rate = start, 1.0
        self._lock = threading.Lock()  # of self._now
        threading.Thread(target=self._send, daemon=True).start()
        wait_until(lambda: rospy.get_time() >= start, "the clock")

    def _send(self):
        while not rospy.is_shutdown():
            with self._lock:
                self._now += 0.01 * self._rate
                now = self._now
            self._publisher.publish(rospy.Time(now))
            time.sleep(0.01)

    def set(self, now):
        with self._lock:
            self._now = now
        wait_until(lambda: 0.0 <= rospy.get_time() - now < 1.0, f"the clock to show {now}")

    def stand_still(self):
        self._rate = 0.0

    def go_on(self):
        self._rate = 1.0


# ---- services

class Services:
    """A node's services, called with numpy arrays."""

    def __init__(self, node="organ_collision"):
        self._find = self._proxy(node + "/find_nearest_triangle", FindNearestTriangle)
        self._find_within = self._proxy(node + "/find_triangles_within", FindTrianglesWithin)
        self._update = self._proxy(node + "/update_mesh", UpdateMesh)
        self._get_mesh = self._proxy(node + "/get_mesh", GetMesh)

    @staticmethod
    def _proxy(name, kind):
        rospy.wait_for_service(name, PATIENCE)
        return rospy.ServiceProxy(name, kind)

    def find(self, points, frame="liver", organ="", stamp=None, **accuracy):
        request = FindNearestTriangleRequest(organ=organ, points=points_message(points))
        request.header.frame_id, request.header.stamp = frame, stamp or rospy.Time()
        for field, value in accuracy.items():
            setattr(request.accuracy, field, value)
        return self._find(request)

    def find_within(self, point, radius, frame="liver", organ="liver", **fields):
        request = FindTrianglesWithinRequest(organ=organ, point=Point(*point), radius=radius, **fields)
        request.header.frame_id = frame
        return self._find_within(request)

    def update(self, positions=(), frame="liver", triangles=(), **fields):
        request = UpdateMeshRequest(positions=np.ravel(positions).tolist(), **fields)
        request.header.frame_id = frame
        request.triangles = [MeshTriangle([int(corner) for corner in triangle]) for triangle in triangles]
        return self._update(request)

    def get_mesh(self, organ=""):
        return self._get_mesh(organ)

    def surface(self, organ=""):
        mesh = self.get_mesh(organ).mesh
        return Surface([coordinates(vertex) for vertex in mesh.vertices],
                       [triangle.vertex_indices for triangle in mesh.triangles])
