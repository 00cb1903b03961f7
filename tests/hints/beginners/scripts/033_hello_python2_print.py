#coding=utf-8
import rclpy
from rclpy.node import Node

class HelloNode(Node):
    def __init__(self):
        super(HelloNode, self).__init__('hello_node')
        self.get_logger().info('hello')

def main():
    rclpy.init()
    node = HelloNode()
    print "节点已经启动"
    rclpy.spin(node)

if __name__ == '__main__':
    main()
