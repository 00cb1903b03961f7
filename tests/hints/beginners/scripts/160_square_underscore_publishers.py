import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareNode(Node):
    def __init__(self):
        super().__init__('square_node')
        self._publishers = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        start = time.time()
        while time.time() - start < t:
            self._publishers.publish(m)
            time.sleep(0.01)
        self._publishers.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = SquareNode()
    time.sleep(1)
    for k in range(4):
        node.drive(1.0, 0.0, 2.0)
        node.drive(0.0, 1.0, 1.5708)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
