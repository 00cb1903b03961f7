import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for i in range(4):
            self.drive(1.0, 0.0, 2.0)
            self.drive(0.0, 1.0, math.pi / 2)
            return True


def main():
    rclpy.init()
    node = Square()
    time.sleep(0.5)
    if node.run():
        node.get_logger().info('成功')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
