#!/usr/bin/env python3
"""The demo, without a display."""
import unittest

import numpy as np
from rostest_support import ContactsInbox, Services, contact_of, coordinates, run

from organ_collision.msg import Contact

STAY_NEAR = 0.03  # [m] the demo's paths keep to 22 mm above and 3 mm inside of the liver
INSTRUMENTS = ("left", "right")


class Demo(unittest.TestCase):
    def test_both_instruments_have_contacts_and_go_on_having_them(self):
        surface = Services().surface("liver")
        contacts = ContactsInbox()
        contacts.wait_for(lambda array: all(contact.status == Contact.OK for contact in array.contacts))
        arrays = contacts.collect(500)
        self.assertEqual({array.header.frame_id for array in arrays}, {"world"})
        for name in INSTRUMENTS:
            of_one = [contact_of(array, name) for array in arrays]
            stale = [contact for contact in of_one if contact.status != Contact.OK]
            self.assertLess(len(stale), 0.05 * len(of_one), "on a loaded machine some come late")
            self.assertLess(max(abs(contact.nearest.distance) for contact in of_one), STAY_NEAR)
            points = [coordinates(contact.instrument_point) for contact in of_one]
            self.assertGreater(np.linalg.norm(points[-1] - points[0]), 0.0)
            # config/instruments.urdf puts the liver 0.15 m over the table.
            last = of_one[-1]
            self.assertAlmostEqual(last.nearest.distance, surface.signed_distance(points[-1] - [0, 0, 0.15]),
                                   delta=1e-12)


if __name__ == "__main__":
    run(Demo)
