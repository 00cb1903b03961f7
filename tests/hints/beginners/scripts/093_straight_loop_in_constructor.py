import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Straight(Node):
    def __init__(self):
        super().__init__('straight')
        self.running = True
        self.get_logger().info('等待启动')
        while self.running:
            time.sleep(0.1)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.go)

    def go(self):
        m = Twist()
        m.linear.x = 1.0
        self.pub.publish(m)


def main():
    rclpy.init()
    node = Straight()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
