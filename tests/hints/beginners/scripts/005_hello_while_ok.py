import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("my_first_node")
logger = node.get_logger()
logger.info("节点启动啦！！！")

# 一直循环，按Ctrl+C退出
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.5)
