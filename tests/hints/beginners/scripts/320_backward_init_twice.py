import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

rclpy.init()


class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        m = Twist()
        m.linear.x = -1.0
        self.pub.publish(m)


def main(args=None):
    rclpy.init(args=args)
    node = Backward()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
