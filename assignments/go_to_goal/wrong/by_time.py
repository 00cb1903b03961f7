"""不看位置，按固定的时间转和走。"""

import time

import rclpy
from geometry_msgs.msg import Twist


def drive(publisher, v, w, seconds):
    msg = Twist()
    msg.linear.x = v
    msg.angular.z = w
    end = time.time() + seconds
    while time.time() < end:
        publisher.publish(msg)
        time.sleep(0.02)
    publisher.publish(Twist())


def main():
    rclpy.init()
    node = rclpy.create_node('go_to_goal')
    publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(0.5)
    drive(publisher, 0.0, -0.8, 1.0)
    drive(publisher, 1.0, 0.0, 1.0)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
