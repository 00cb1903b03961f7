import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('recursive')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)


def publish(v, w, seconds):
    if seconds < 0.05:
        return
    msg = Twist()
    msg.linear.x = v
    msg.angular.z = w
    pub.publish(msg)
    time.sleep(0.1)
    publish(v, w, seconds - 0.1)


def branch(depth):
    if depth == 0:
        return
    publish(0.5 * depth, 0.0, 0.5)
    publish(0.0, 1.0, 0.5)
    branch(depth - 1)


branch(3)
pub.publish(Twist())
