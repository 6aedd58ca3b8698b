"""A liver that is deformed by service and by stream, with a tip that stands still above it."""
import unittest

import numpy as np
import rospy
from rostest_support import ContactsInbox, Frames, Inbox, Pose, Services, check_nearest, wait_until

from organ_collision.msg import MeshInfo, MeshInfoArray, MeshUpdate
from organ_collision.srv import UpdateMeshRequest

REFITS = (MeshInfo.REFIT, MeshInfo.PARTIAL_REFIT)
TIP = np.array([0.02, 0.01, 0.12])  # [m] in the organ's frame


class DeformingLiver(unittest.TestCase):
    """Starts each test with the liver as it was loaded."""

    @classmethod
    def setUpClass(cls):
        Frames().fix(("liver", "fixed_tip", Pose(TIP)))
        cls.services = Services()
        cls.loaded = cls.services.surface()
        cls.contacts = ContactsInbox()
        cls.infos = Inbox("organ_collision/mesh_info", MeshInfoArray)
        cls.stream = rospy.Publisher("organ_collision/mesh_update", MeshUpdate, queue_size=5000, tcp_nodelay=True)
        wait_until(lambda: cls.stream.get_num_connections() == 1, "the node to hear mesh updates")

    def setUp(self):
        self.version = self.update(self.loaded.vertices, triangles=self.loaded.triangles).mesh_version
        self.contacts.forget()
        self.infos.forget()

    def deformed(self, size=0.01, phase=0.0):
        """The loaded liver's vertices, bent by up to `size` [m]."""
        x, y, z = self.loaded.vertices.T
        return np.column_stack([x, y, z + size * np.sin(30.0 * x + phase) * np.cos(20.0 * y)])

    def update(self, *positions, **fields):
        answer = self.services.update(*positions, **fields)
        self.assertTrue(answer.success, answer.message)
        return answer

    def check_queries(self, surface, version):
        """They see this geometry; contacts too, soon."""
        answer = self.services.find([TIP])
        self.assertEqual(answer.mesh_version, version)
        truth = surface.signed_distance(TIP)
        check_nearest(self, answer.nearest[0], TIP, surface, truth)
        contact = self.contacts.contact("fixed", lambda contact: contact.mesh_version == version)
        check_nearest(self, contact.nearest, TIP, surface, truth)

    def latest_info(self, is_wanted):
        return self.infos.wait_for(lambda array: is_wanted(array.meshes[0])).meshes[0]

    def send(self, positions, indices=(), frame="liver", organ="liver"):
        message = MeshUpdate(organ=organ, indices=indices, positions=np.ravel(positions).astype(np.float32))
        message.header.frame_id = frame
        self.stream.publish(message)

    def account(self):
        """The node's, of the current version."""
        self.infos.forget()
        self.update(mode=UpdateMeshRequest.REBUILD)
        return self.latest_info(lambda info: info.last_action == MeshInfo.REBUILD)
