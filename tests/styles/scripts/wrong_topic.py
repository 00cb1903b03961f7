import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('lost')
pub = node.create_publisher(Twist, '/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.0
for _ in range(20):
    pub.publish(msg)
    time.sleep(0.1)
