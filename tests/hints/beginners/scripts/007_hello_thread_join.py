import threading
import rclpy
from rclpy.node import Node


def work(node):
    node.get_logger().info('线程里的 hello')
    rclpy.spin(node)


if __name__ == '__main__':
    rclpy.init()
    node = Node('thread_node')
    t = threading.Thread(target=work, args=(node,), daemon=True)
    t.start()
    try:
        t.join()
    except KeyboardInterrupt:
        pass
