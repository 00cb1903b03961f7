import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
import time


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.pose_callback, 10)
        self.timer = self.create_timer(1.0, self.run)
        self.x = 5.54
        self.y = 5.54

    def pose_callback(self, msg):
        self.x = msg.x
        self.y = msg.y

    def run(self):
        self.timer.cancel()
        for i in range(4):
            x0 = self.x
            y0 = self.y
            m = Twist()
            m.linear.x = 1.0
            # 走到2米为止
            while math.sqrt((self.x - x0) ** 2 + (self.y - y0) ** 2) < 2.0:
                self.pub.publish(m)
                time.sleep(0.01)
            m = Twist()
            m.angular.z = 1.0
            t = time.time()
            while time.time() - t < 1.5708:
                self.pub.publish(m)
                time.sleep(0.01)
            self.pub.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(Square())


if __name__ == '__main__':
    main()
