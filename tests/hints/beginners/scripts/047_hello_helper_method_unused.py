import rclpy
from rclpy.node import Node


class Robot(Node):
    def __init__(self, name='robot'):
        super().__init__(name)
        self.robot_name = name

    def say_hello(self):
        self.get_logger().info(f'{self.robot_name}: 你好，ROS2')


def main():
    rclpy.init()
    r = Robot('xiaoming')
    r.say_hello
    try:
        rclpy.spin(r)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
