import rclpy
from rclpy.node import Node

def main():
    rclpy.init()
    节点 = Node('我的节点')
    节点.get_logger().info('你好，世界')
    rclpy.spin(节点)

main()
