import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def run(self):
        i = 0
        while i <= 4:
            self.drive(1.0, 0.0, 2.0)
            self.drive(0.0, 1.0, 1.5708)
            i = i + 1


rclpy.init()
s = Square()
time.sleep(1)
s.run()
rclpy.shutdown()
