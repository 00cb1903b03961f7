from datetime import datetime, timedelta
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('dated')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 0.5
msg.angular.z = 0.5
started = datetime.now()
deadline = started + timedelta(seconds=3)
while datetime.now() < deadline:
    pub.publish(msg)
    time.sleep(0.1)
pub.publish(Twist())
print((datetime.now() - started).seconds, '秒')
