import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class TriangleMover(Node):
    def __init__(self):
        super().__init__('triangle_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def straight(self):
        msg = Twist()
        msg.linear.x = 1.0
        msg.angular.z = 0.0
        self.repeat(msg, 2.0)

    def turn(self):
        msg = Twist()
        msg.linear.x = 0
        msg.angular.z = 1.0
        self.repeat(msg, 2.094)

    def repeat(self, msg, duration):
        end = time.time() + duration
        while time.time() < end:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = TriangleMover()
    time.sleep(1)
    for _ in range(3):
        node.straight()
        node.turn()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
