import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

speed = 0.5
seconds = 4

rclpy.init()
node = Node('houtui')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)

cmd = Twist()
cmd.linear.x = -abs(speed)
for k in range(seconds * 10):
    publisher.publish(cmd)
    time.sleep(0.1)

cmd.linear.x = 0.0
publisher.publish(cmd)
time.sleep(0.5)
node.destroy_node()
rclpy.shutdown()
