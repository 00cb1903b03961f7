import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Config(Node):
    def __init__(self):
        super().__init__('config_server')
        # TODO: publisher, subscription, and the first message


def main():
    rclpy.init()
    node = Config()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
