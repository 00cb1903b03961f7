import rclpy
import time
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node('shouxie')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)


def fa(x, z, n):
    m = Twist()
    m.linear.x = x
    m.angular.z = z
    for _ in range(n):
        pub.publish(m)
        time.sleep(0.1)


# 第一条边
fa(1.0, 0.0, 20)
fa(0.0, 1.5708, 10)
# 第二条边
fa(1.0, 0.0, 20)
fa(0.0, 1.5708, 10)
# 第三条边
fa(1.0, 0.0, 20)
fa(0.0, -1.5708, 10)
# 第四条边
fa(1.0, 0.0, 20)
fa(0.0, 1.5708, 10)
fa(0.0, 0.0, 2)
rclpy.shutdown()
