import threading
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('rate_node')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    rate = node.create_rate(20)
    for i in range(4):
        for cmd in ((1.0, 0.0), (0.0, math.pi / 2)):
            msg = Twist()
            msg.linear.x, msg.angular.z = cmd
            for _ in range(20):
                pub.publish(msg)
                rate.sleep()
    pub.publish(Twist())
    rclpy.shutdown()
    thread.join()
    print('joined')


main()
