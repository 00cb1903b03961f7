import time
import rclpy
from rclpy.node import Node
from turtlesim.msg import Pose
from geometry_msgs.msg import Twist


class Poll(Node):
    def __init__(self):
        super().__init__('poll')
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)

    def cb(self, msg):
        self.pose = msg


rclpy.init()
node = Poll()
while node.pose is None:
    rclpy.spin_once(node, timeout_sec=0)
x0 = node.pose.x
go = Twist()
go.linear.x = 1.0
while node.pose.x - x0 < 2.0:
    node.pub.publish(go)
    rclpy.spin_once(node, timeout_sec=0)
    time.sleep(0.001)
node.pub.publish(Twist())
rclpy.shutdown()
