import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self):
        for (int i = 0; i < 4; i++) {
            self.go(1.0, 0.0, 2.0);
            self.go(0.0, 1.0, 1.5708);
        }

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)

rclpy.init()
s = Square()
s.run()
