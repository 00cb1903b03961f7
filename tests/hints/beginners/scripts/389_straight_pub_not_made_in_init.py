import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Car(Node):
    def __init__(self):
        super().__init__('car')
        self.timer = self.create_timer(0.1, self.zou)

    def setup(self):
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def zou(self):
        m = Twist()
        m.linear.x = 1.0
        self.pub.publish(m)


def main(args=None):
    rclpy.init(args=args)
    c = Car()
    rclpy.spin(c)


if __name__ == '__main__':
    main()
