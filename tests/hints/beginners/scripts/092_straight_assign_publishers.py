import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Straight(Node):
    def __init__(self):
        super().__init__('straight')
        self.publishers = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.publishers.publish(msg)


def main():
    rclpy.init()
    node = Straight()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
