import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
n = rclpy.create_node('busy')
p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
m = Twist()
m.linear.x = 1.0
while True:
    p.publish(m)
