import rclpy
from rclpy.node import Node


class MyNode(Node):
    def __init__(self):
        super().__init__()          # 调用父类初始化
        self.get_logger().info('启动成功')


def main():
    rclpy.init()
    my = MyNode()
    rclpy.spin(my)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
