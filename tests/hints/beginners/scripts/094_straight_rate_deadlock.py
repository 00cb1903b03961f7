import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('rate_go')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
rate = node.create_rate(10)
msg = Twist()
msg.linear.x = 1.0
while rclpy.ok():
    pub.publish(msg)
    rate.sleep()      # 10Hz
