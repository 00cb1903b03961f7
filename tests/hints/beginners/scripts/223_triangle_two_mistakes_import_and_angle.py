import rclpy
import time
from rclpy.node import Node
from geometry_msgs.srv import Twist

class San(Node):
    def __init__(self):
        super().__init__('san')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self):
        for i in range(3):
            self.fa(1.0, 0.0, 2.0)
            self.fa(0.0, 1.0, 1.047)

    def fa(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())

rclpy.init()
s = San()
time.sleep(1)
s.run()
