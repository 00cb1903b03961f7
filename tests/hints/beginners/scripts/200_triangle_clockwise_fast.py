from math import pi
from time import sleep, time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('sanjiao')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
sleep(1)


def run(v, w, t):
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    end = time() + t
    while time() < end:
        pub.publish(m)
        sleep(0.01)
    pub.publish(Twist())
    sleep(0.1)


# 顺时针，边长3，很快
for 边 in '一二三':
    print('第', 边, '条边')
    run(2.0, 0.0, 1.5)
    run(0.0, -2.0, 2 * pi / 3 / 2.0)

rclpy.shutdown()
