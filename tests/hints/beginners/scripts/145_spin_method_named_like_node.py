import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Rot(Node):
    def __init__(self):
        super().__init__('rot')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.rotate)

    def rotate(self):
        msg = Twist()
        msg.angular.z = 1.0
        self.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Rot())


if __name__ == '__main__':
    main()
