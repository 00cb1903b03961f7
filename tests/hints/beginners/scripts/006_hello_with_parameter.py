# 带参数的hello，可以用 --ros-args -p name:=小红 改名字
import rclpy
from rclpy.node import Node


class Hello(Node):
    def __init__(self):
        super().__init__('hello_param')
        self.declare_parameter('name', '世界')
        name = self.get_parameter('name').get_parameter_value().string_value
        assert name != '', '名字不能为空'
        self.get_logger().info('你好，' + name)


def run():
    rclpy.init()
    node = Hello()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()


if __name__ == "__main__":
    run()
