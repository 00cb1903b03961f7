import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.msg = Twist()      # 共用一个消息

    def send(self, t):
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(self.msg)
            time.sleep(0.01)

    def run(self):
        for i in range(4):
            self.msg.linear.x = 1.0
            self.msg.angular.z = 0.0
            self.send(1.5)
            self.msg.angular.z = 1.0
            self.send(1.5708)
        self.msg.linear.x = 0.0
        self.msg.angular.z = 0.0
        self.send(0.2)


def main():
    rclpy.init()
    sq = Square()
    time.sleep(1)
    sq.run()
    rclpy.shutdown()


main()
