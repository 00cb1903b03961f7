import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
import time, math

class M(Node):
    def __init__(self):
        super().__init__('m')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.x = 5.5
        self.theta = 0.0

    def cb(self, msg):
        self.x = msg.x
        self.theta = msg.theta

    def run(self):
        cmd = Twist()
        cmd.linear.x = 1.0
        while self.x < 7.5:
            self.pub.publish(cmd)
            time.sleep(0.1)
        cmd.linear.x = 0.0
        cmd.angular.z = 0.5
        while self.theta < 1.57:
            self.pub.publish(cmd)
            time.sleep(0.1)
        self.pub.publish(Twist())

rclpy.init()
m = M()
import threading
t = threading.Thread(target=rclpy.spin, args=(m,))
m.run()
