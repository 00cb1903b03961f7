import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Go(Node):
    def __init__(self):
        super().__init__('go')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.msg = Twist()
        self.msg.linear.x = 1.5
        self.create_timer(0.1, self.fa)

    def fa(self):
        # 发布
        self.p.publish(Twist())


def main():
    rclpy.init()
    node = Go()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
