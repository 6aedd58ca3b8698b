#!/usr/bin/env python3
"""The demo, without a display."""
import subprocess
import unittest

import numpy as np
import roslib.packages
from rostest_support import ContactsInbox, Services, Surface, contact_of, coordinates, run, wait_until

from organ_collision.msg import Contact

STAY_NEAR = 0.03  # [m] the demo's paths keep to 20 mm above and 10 mm inside of the liver at rest
DENT = 0.005  # [m] the least that both instruments press it in
ROUND = 40.0  # [s] within which each instrument has gone its round, of 24 s at most
FREQUENCY = 60.0  # [Hz] of the simulated organ
HOLDS_STILL = 1e-6  # [m] of what nothing touches: a float's digits
INSTRUMENTS = ("left", "right")


class Demo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services()
        cls.at_rest = Surface.shipped()
        cls.contacts = ContactsInbox()
        cls.contacts.wait_for(lambda array: all(contact.status == Contact.OK for contact in array.contacts))

    def moved(self):
        """How far each vertex is from the file's [m]."""
        return np.linalg.norm(self.services.surface().vertices - self.at_rest.vertices, axis=1)

    def test_both_instruments_have_contacts_and_go_on_having_them(self):
        arrays = self.contacts.collect(500)
        self.assertEqual({array.header.frame_id for array in arrays}, {"world"})
        for name in INSTRUMENTS:
            of_one = [contact_of(array, name) for array in arrays]
            stale = [contact for contact in of_one if contact.status != Contact.OK]
            self.assertLess(len(stale), 0.05 * len(of_one), "on a loaded machine some come late")
            self.assertLess(max(abs(contact.nearest.distance) for contact in of_one), STAY_NEAR)
            points = [coordinates(contact.instrument_point) for contact in of_one]
            self.assertGreater(np.linalg.norm(points[-1] - points[0]), 0.0)

    def test_contacts_are_right_for_the_mesh_that_they_name(self):
        for _ in range(20):  # a loaded machine may make no contacts of one version
            self.contacts.forget()
            answer = self.services.get_mesh()
            array = self.contacts.find(lambda array: array.contacts[0].mesh_version == answer.mesh_version, 1.0)
            if array is not None:
                break
        self.assertIsNotNone(array, "no contacts of any of twenty versions")
        surface = self.at_rest.of([coordinates(vertex) for vertex in answer.mesh.vertices])
        for contact in array.contacts:
            # config/instruments.urdf puts the liver 0.15 m over the table.
            tip = coordinates(contact.instrument_point) - [0, 0, 0.15]
            self.assertAlmostEqual(contact.nearest.distance, surface.signed_distance(tip), delta=1e-12)

    def test_its_programs_say_what_they_miss(self):
        for name, missed in (("demo_organ", "/nobody/organ"), ("demo_instruments", "/nobody/rate")):
            program = roslib.packages.find_node("organ_collision", name)[0]
            ended = subprocess.run([program, "__name:=nobody"], capture_output=True, text=True, timeout=10.0, check=False)
            self.assertEqual(ended.returncode, 1, name)
            self.assertIn(f"parameter {missed} is missing", ended.stderr)

    def test_the_organ_deforms_as_often_as_it_is_simulated(self):
        arrays = self.contacts.collect(1500)
        versions = arrays[-1].contacts[0].mesh_version - arrays[0].contacts[0].mesh_version
        seconds = (arrays[-1].header.stamp - arrays[0].header.stamp).to_sec()
        self.assertGreater(versions / seconds, 0.5 * FREQUENCY, "on a loaded machine some are merged")
        self.assertLess(versions / seconds, 1.1 * FREQUENCY)

    def test_each_instrument_touches_the_organ_and_leaves_it_again(self):
        to_come = {name: [True, False, True] for name in INSTRUMENTS}

        def all_have_come(array):
            for name, touches in to_come.items():
                if touches and contact_of(array, name).colliding == touches[0]:
                    touches.pop(0)
            return not any(to_come.values())

        self.contacts.forget()
        self.contacts.wait_for(all_have_come, 2 * ROUND)

    def test_the_instruments_press_dents_and_the_rest_stays(self):
        wait_until(lambda: self.moved().max() > DENT, "a dent", ROUND)
        below = self.at_rest.vertices[:, 2] < -0.03
        self.assertGreater(below.sum(), 0)
        self.assertLess(self.moved()[below].max(), HOLDS_STILL)


if __name__ == "__main__":
    run(Demo)
