import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def act(self, v, w, t):
        Twist = Twist()
        Twist.linear.x = v
        Twist.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(Twist)
            time.sleep(0.01)


def main():
    rclpy.init()
    node = Pentagon()
    time.sleep(1)
    for i in range(5):
        node.act(1.0, 0.0, 2.0)
        node.act(0.0, 1.0, 1.257)
    node.act(0.0, 0.0, 0.1)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
