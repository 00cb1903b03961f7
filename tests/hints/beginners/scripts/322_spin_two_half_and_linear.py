import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

rclpy.init()
node = Node('turner')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
msg = Twist()
msg.linear.x = 0.5
msg.angular.z = 1.0
t = time.time()
while time.time() - t < 3.14:
    pub.publish(msg)
    time.sleep(0.02)
pub.publish(Twist())
time.sleep(0.2)
rclpy.shutdown()
