import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Forgotten(Node):
    def __init__(self):
        super().__init__('forgotten')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)


def main():
    rclpy.init()
    rclpy.spin(Forgotten())
