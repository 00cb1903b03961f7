import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.side = 2.0
        self.turn = 1.5708

    def line(self):
        m = Twist()
        m.linear.x = 1.0
        self._keep(m, self.side)

    def turn(self):
        m = Twist()
        m.angular.z = 1.0
        self._keep(m, 1.5708)

    def _keep(self, m, t):
        start = time.time()
        while time.time() - start < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


rclpy.init()
sq = Square()
time.sleep(1)
for i in range(4):
    sq.line()
    sq.turn()
rclpy.shutdown()
