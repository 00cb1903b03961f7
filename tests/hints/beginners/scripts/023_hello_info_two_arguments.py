import rclpy
from rclpy.node import Node


class Student(Node):
    def __init__(self):
        super().__init__('student')
        self.xuehao = 20240233
        self.get_logger().info('我的学号是', self.xuehao)


def main():
    rclpy.init()
    s = Student()
    try:
        rclpy.spin(s)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
