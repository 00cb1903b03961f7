import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

SPEED = 0.0
JULI = 2.0


def main():
    rclpy.init()
    node = Node('zhi')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    t = JULI / SPEED
    m = Twist()
    m.linear.x = SPEED
    end = time.time() + t
    while time.time() < end:
        pub.publish(m)
        time.sleep(0.1)
    pub.publish(Twist())


main()
