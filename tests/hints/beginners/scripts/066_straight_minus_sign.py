import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Car(Node):
    speed = -1.0
    def __init__(self):
        super().__init__('car')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self, sec):
        end = time.time() + sec
        cmd = Twist()
        cmd.linear.x = self.speed
        while time.time() < end:
            self.pub.publish(cmd)
            time.sleep(0.02)
        self.pub.publish(Twist())

rclpy.init()
c = Car()
time.sleep(1)
c.run(3)
