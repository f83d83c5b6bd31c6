#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Drives the cart forward until it has come a metre far, and stops it."""
import rospy
from geometry_msgs.msg import TwistStamped
from rigid_body_sim.srv import GetBody

rospy.init_node('drive_cart')
get_body = rospy.ServiceProxy('/sim/get_body', GetBody)
commands = rospy.Publisher('/sim/cmd_twist', TwistStamped, queue_size=1)


def drive(speed):
    command = TwistStamped()
    command.header.frame_id = 'cart'  # the body, and the frame in which its twist is given
    command.twist.linear.x = speed  # m/s
    commands.publish(command)


rospy.wait_for_service('/sim/get_body')
rate = rospy.Rate(20)  # Hz of simulated time: it stands still while the simulation is paused
while not rospy.is_shutdown() and get_body('cart').body.pose.position.x < 1.0:
    drive(0.5)
    rate.sleep()
while not rospy.is_shutdown() and get_body('cart').body.twist.linear.x > 0.0:
    drive(0.0)
    rate.sleep()
print('the cart stopped at x = %.2f m' % get_body('cart').body.pose.position.x)
