import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def move(self, v, w, time):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start = time.time()
        while time.time() - start < time:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = SquareMover()
    for i in range(4):
        node.move(1.0, 0.0, 2.0)
        node.move(0.0, 1.0, 1.5708)


if __name__ == '__main__':
    main()
