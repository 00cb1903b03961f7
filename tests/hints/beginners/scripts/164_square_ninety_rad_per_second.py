import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Zheng(Node):
    def __init__(self):
        super().__init__('zheng')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def zou(self, su, jiao, miao):
        t = Twist()
        t.linear.x = su
        t.angular.z = jiao
        for i in range(int(miao / 0.02)):
            self.pub.publish(t)
            time.sleep(0.02)
        self.pub.publish(Twist())
        time.sleep(0.2)

rclpy.init()
z = Zheng()
time.sleep(1)
for i in range(4):
    z.zou(1.0, 0.0, 2)      # 走2秒
    z.zou(0.0, 90.0, 1)     # 1秒转90度
rclpy.shutdown()
