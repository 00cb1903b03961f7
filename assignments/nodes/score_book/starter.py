import rclpy
from rclpy.node import Node


class ScoreBook(Node):
    def __init__(self):
        super().__init__('score_book')
        # TODO: subscription and service


def main():
    rclpy.init()
    node = ScoreBook()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
