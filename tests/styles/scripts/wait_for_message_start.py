import rclpy
from rclpy.wait_for_message import wait_for_message
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
import time

rclpy.init()
node = rclpy.create_node('waiter')
ok, pose = wait_for_message(Pose, node, '/turtle1/pose', time_to_wait=5.0)
print(ok, round(pose.x, 3), round(pose.y, 3))
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.0
for _ in range(int((9.544445 - pose.x) / 1.0 * 10 + 0.5)):
    pub.publish(msg)
    time.sleep(0.1)
pub.publish(Twist())
