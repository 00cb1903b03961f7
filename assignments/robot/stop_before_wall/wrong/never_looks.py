import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Blind(Node):
    def __init__(self):
        super().__init__('blind')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        msg = Twist()
        msg.linear.x = 0.2
        self.publisher.publish(msg)


rclpy.init()
rclpy.spin(Blind())
