import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareNode(Node):
    def __init__(self):
        super().__init__('square_node')
        self.declare_parameter('length', 2.0)
        self.a = self.get_parameter('length').value
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

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


rclpy.init()
n = SquareNode()
time.sleep(1)
for _ in range(4):
    n.go(1.0, 0.0, n.a)
    n.go(0.0, 1.0, 1.5708)
n.destroy_node()
rclpy.shutdown()
