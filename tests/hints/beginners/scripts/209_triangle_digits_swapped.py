import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time

TURN_SPEED = 1.0
TURN_TIME_TRIANGLE = 2.904 / TURN_SPEED

class TriangleNode(Node):
    def __init__(self):
        super().__init__('triangle_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def send(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() < s + t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

rclpy.init()
node = TriangleNode()
time.sleep(1)
for i in range(3):
    node.send(1.0, 0.0, 2.0)
    node.send(0.0, TURN_SPEED, TURN_TIME_TRIANGLE)
rclpy.shutdown()
