import sys
import time
import rclpy
from geometry_msgs.msg import Twist

KEYS = {'w': (1.0, 0.0), 's': (-1.0, 0.0), 'a': (0.0, 1.0), 'd': (0.0, -1.0)}
rclpy.init()
node = rclpy.create_node('teleop')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
for line in sys.stdin:
    for key in line.strip():
        v, w = KEYS.get(key, (0.0, 0.0))
        twist = Twist()
        twist.linear.x = v
        twist.angular.z = w
        pub.publish(twist)
        time.sleep(0.5)
pub.publish(Twist())
