#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The node under test, drive_cart.py, drives the cart of a simulated world."""
import unittest

import rospy
import rostest
from rigid_body_sim.srv import GetBody, Step


class DriveCartTest(unittest.TestCase):
    def test_the_cart_stops_beyond_a_metre_and_has_pushed_the_box(self):
        rospy.wait_for_service('/sim/step')
        step = rospy.ServiceProxy('/sim/step', Step)
        get_body = rospy.ServiceProxy('/sim/get_body', GetBody)
        cart = get_body('cart').body
        while cart.pose.position.x < 1.0 or cart.twist.linear.x > 0.0:  # for ever: time-limit ends it
            self.assertTrue(step(1).success)
            cart = get_body('cart').body
        self.assertGreater(get_body('box').body.pose.position.x, 1.3)


if __name__ == '__main__':
    rospy.init_node('drive_cart_test')
    rostest.rosrun('rigid_body_sim', 'drive_cart_test', DriveCartTest)
