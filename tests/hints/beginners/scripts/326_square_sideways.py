import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class XY(Node):
    """右 上 左 下"""

    def __init__(self):
        super().__init__('xy')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def move(self, x, y):
        m = Twist()
        m.linear.x = x
        m.linear.y = y
        for i in range(20):
            self.pub.publish(m)
            time.sleep(0.1)
        self.pub.publish(Twist())
        time.sleep(0.2)


rclpy.init()
node = XY()
time.sleep(1)
node.move(1.0, 0.0)
node.move(0.0, 1.0)
node.move(-1.0, 0.0)
node.move(0.0, -1.0)
rclpy.shutdown()
