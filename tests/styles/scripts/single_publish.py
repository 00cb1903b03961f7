import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

rclpy.init()
node = Node('one_shot')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 2.0
msg.angular.z = 1.0
pub.publish(msg)
print('published once')
rclpy.shutdown()
