import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Triangle(Node):
    def __init__(self):
        super().__init__('triangle_feedback')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.pose = None

    def cb(self, msg):
        self.pose = msg

    def line(self, a):
        x, y = self.pose.x, self.pose.y
        m = Twist()
        m.linear.x = 1.0
        while math.hypot(self.pose.x - x, self.pose.y - y) < a:
            self.pub.publish(m)
            time.sleep(0.01)


def main():
    rclpy.init()
    node = Triangle()
    while node.pose is None:
        print('等待位姿...')
        time.sleep(0.5)
    for i in range(3):
        node.line(2.0)
        m = Twist()
        m.angular.z = 2.094
        t = time.time()
        while time.time() - t < 1:
            node.pub.publish(m)
            time.sleep(0.01)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
