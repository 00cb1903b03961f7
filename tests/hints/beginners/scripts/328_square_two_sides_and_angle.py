import rclpy
import time
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Fang(Node):
    def __init__(self):
        super().__init__('fang')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def zou(self):
        m = Twist()
        m.linear.x = 1.0
        for i in range(20):
            self.pub.publish(m)
            time.sleep(0.1)

    def guai(self):
        m = Twist()
        m.angular.z = 1.0
        for i in range(10):
            self.pub.publish(m)
            time.sleep(0.1)


rclpy.init()
fang = Fang()
time.sleep(1)
for i in range(3):
    fang.zou()
    fang.guai()
fang.pub.publish(Twist())
time.sleep(0.3)
rclpy.shutdown()
