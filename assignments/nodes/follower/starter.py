import rclpy
from rclpy.node import Node


class Follower(Node):
    def __init__(self):
        super().__init__('follower')
        # TODO: spawn turtle2, send both frames, look up, drive


def main():
    rclpy.init()
    node = Follower()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
