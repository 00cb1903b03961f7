import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('beginner')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.0
for i in range(15):
    pub.publish(msg)
    time.sleep(0.1)
msg.linear.x = 0
pub.publish(msg)
