import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time

rclpy.init()
node = Node('one_shot')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(2)            # 等连接
t = Twist()
t.linear.x = 2.0
pub.publish(t)           # 只发一次，小乌龟自己会走1秒
time.sleep(2)
node.destroy_node()
rclpy.shutdown()
