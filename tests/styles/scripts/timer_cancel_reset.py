import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Blinker(Node):
    """The drive timer is paused and resumed by a second, slower timer."""

    def __init__(self):
        super().__init__('blinker')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.drive_timer = self.create_timer(0.1, self.drive)
        self.switch_timer = self.create_timer(1.05, self.switch)

    def drive(self):
        msg = Twist()
        msg.linear.x = 0.8
        self.pub.publish(msg)

    def switch(self):
        if self.drive_timer.is_canceled():
            self.get_logger().info('resume')
            self.drive_timer.reset()
        else:
            self.get_logger().info('pause')
            self.drive_timer.cancel()
            self.pub.publish(Twist())


rclpy.init()
rclpy.spin(Blinker())
