import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.get_logger().info('🎯 正方形控制节点启动!')

    def cmd(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.cmd(1.0, 0.0, 2.0)
            self.cmd(0.0, 1.0, 1.5708)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    node.move_square
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
