import copy
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('copier')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
forward = Twist()
forward.linear.x = 1.0
curve = copy.deepcopy(forward)
curve.angular.z = 1.0
print(forward == curve, forward.linear)
for msg in (forward, curve):
    for _ in range(10):
        pub.publish(msg)
        time.sleep(0.1)
pub.publish(Twist())
