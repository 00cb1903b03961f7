import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('busy_time')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.5
t0 = time.time()
while time.time() - t0 < 2.0:
    pub.publish(msg)
msg.linear.x = 0.0
pub.publish(msg)
print(f'{time.time() - t0:.1f}')
