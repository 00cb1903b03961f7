import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

rclpy.init()
node = Node('zhuanquan')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
i = 0
while i < 63:
    t = Twist()
    t.angular.z = 1.0
    pub.publish(t)
    time.sleep(0.1)
print('转完一圈')
