import rclpy
from rclpy.node import Node

robot = {'name': '小龟', 'battery': 80}


class Say(Node):
    def __init__(self):
        super().__init__('say')
        self.get_logger().info('电量 ' + str(robot['batery']))


def main():
    rclpy.init()
    rclpy.spin(Say())


if __name__ == '__main__':
    main()
