import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareMover(Node):
    """走正方形"""

    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def publish_for(self, msg, duration):
        start = time.time()
        while time.time() - start < duration:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        qian = Twist()
        qian.linear.x = 1.0
        zhuan = Twist()
        zhuan.angular.z = math.pi / 4
        for i in range(1, 4):
            self.get_logger().info(f'第{i}条边')
            self.publish_for(qian, 2.0)
            self.publish_for(zhuan, 2.0)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
