import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def move(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def square(self):
        count = 0
        while count < 4:
            self.move(1.0, 0.0, 2.0)
            self.move(0.0, 1.0, 1.5708)
            print('边数:', count)


rclpy.init()
node = Square()
time.sleep(1)
node.square()
