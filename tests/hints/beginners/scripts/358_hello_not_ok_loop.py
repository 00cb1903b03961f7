import rclpy
import time
from rclpy.node import Node

rclpy.init()
node = Node('nihao')
while not rclpy.ok():
    node.get_logger().info('你好 ROS2')
    time.sleep(1)
node.destroy_node()
rclpy.shutdown()
