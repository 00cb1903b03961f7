import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())

rclpy.init()
node = Pentagon()
node.get_logger().info('开始走五边形)
time.sleep(1)
for i in range(5):
    node.drive(1.0, 0.0, 2.0)
    node.drive(0.0, 1.0, 1.257)
rclpy.shutdown()
