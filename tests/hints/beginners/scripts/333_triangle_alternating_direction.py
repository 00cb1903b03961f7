import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class San(Node):
    def __init__(self):
        super().__init__('san')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.w = 1.0

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for i in range(3):
            self.go(1.0, 0.0, 2.0)
            self.go(0.0, self.w, 2.094)
            self.w *= -1.0


rclpy.init()
san = San()
time.sleep(1)
san.run()
rclpy.shutdown()
