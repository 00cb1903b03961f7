import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Straight(Node):
    def __init__(self):
        super().__init__('straight')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
        # 继续下一次
        self.timer_callback()


def main():
    rclpy.init()
    node = Straight()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
