import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('wubianxing')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)

for bian in range(1, 5):
    m = Twist()
    m.linear.x = 1.0
    for i in range(20):
        pub.publish(m)
        time.sleep(0.1)
    m = Twist()
    m.angular.z = 72.0
    for i in range(10):
        pub.publish(m)
        time.sleep(0.1)

pub.publish(Twist())
time.sleep(0.5)
node.destroy_node()
rclpy.shutdown()
