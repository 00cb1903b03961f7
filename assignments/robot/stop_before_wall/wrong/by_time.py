import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('by_time')
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
time.sleep(1.0)
msg = Twist()
msg.linear.x = 0.2
publisher.publish(msg)
time.sleep(7.0)  # right for one room only
publisher.publish(Twist())
time.sleep(1.0)
