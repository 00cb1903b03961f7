import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Careful(Node):
    def __init__(self):
        super().__init__('careful')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, seconds):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
        time.sleep(seconds)

    def __del__(self):
        self.pub.publish(Twist())
        print('stopped')


rclpy.init()
turtle = Careful()
turtle.go(0.5)
