import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Ticks(Node):
    def __init__(self):
        super().__init__('ticks')
        self.n = 0
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.cb)

    def cb(self):
        self.n = self.n + 1
        m = Twist()
        if self.n < 40:
            m.linear.x = 1.0
            self.p.publish(m)
        elif self.n < 45:
            self.p.publish(m)
        else:
            raise SystemExit


def main():
    rclpy.init()
    node = Ticks()
    try:
        rclpy.spin(node)
    except SystemExit:
        node.get_logger().info('结束')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
