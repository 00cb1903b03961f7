import rclpy
from rclpy.node import Node

rclpy.init()
node = Node('hello_node')
node.loginfo('hello')
rclpy.spin(node)
