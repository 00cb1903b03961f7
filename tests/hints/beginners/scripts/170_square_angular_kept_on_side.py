import rclpy
import time
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('fang')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
cmd = Twist()

def fa(shijian):
    t0 = time.time()
    while time.time() < t0 + shijian:
        pub.publish(cmd)
        time.sleep(0.01)

for bian in range(4):
    cmd.linear.x = 1.0
    fa(2.0)
    cmd.linear.x = 0.0
    cmd.angular.z = 1.0
    fa(1.57)

pub.publish(Twist())
time.sleep(0.2)
node.destroy_node()
rclpy.shutdown()
