import math
import time
import rclpy
from geometry_msgs.msg import Twist, Vector3

rclpy.init()
node = rclpy.create_node('figure_eight')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
period = 2 * math.pi / 2.0
for w in (2.0, -2.0):
    t0 = time.monotonic()
    while time.monotonic() < t0 + period:
        pub.publish(Twist(linear=Vector3(x=2.0), angular=Vector3(z=w)))
        time.sleep(0.01)
pub.publish(Twist())
node.destroy_node()
rclpy.shutdown()
