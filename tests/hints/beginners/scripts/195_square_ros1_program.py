#!/usr/bin/env python
# -*- coding: utf-8 -*-
import rospy
from geometry_msgs.msg import Twist
from math import pi

rospy.init_node('draw_square')
pub = rospy.Publisher('/turtle1/cmd_vel', Twist, queue_size=10)
rate = rospy.Rate(1)
rospy.sleep(1)

move_cmd = Twist()
move_cmd.linear.x = 2.0
turn_cmd = Twist()
turn_cmd.angular.z = pi / 2

for i in range(4):
    pub.publish(move_cmd)
    rate.sleep()
    pub.publish(turn_cmd)
    rate.sleep()
rospy.loginfo("画完正方形")
