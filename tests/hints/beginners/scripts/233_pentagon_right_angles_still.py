import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('pentagon_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SIDES = 5
        self.TURN_TIME = 1.5708

    def run(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = self.get_clock().now()
        while (self.get_clock().now() - s).nanoseconds < t * 1e9:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    for i in range(node.SIDES):
        node.run(1.0, 0.0, 2.0)
        node.run(0.0, 1.0, node.TURN_TIME)
    node.get_logger().info('五边形完成')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
