import rclpy
from rclpy.node import Node

def main():
    rclpy.init()
    node = Node('hello')
    try:
        rclpy.spin(node)          # 保持运行
    except KeyboardInterrupt:
        pass
    node.get_logger().info('Hello，节点启动')
    node.destroy_node()
    rclpy.try_shutdown()

if __name__ == '__main__':
    main()
