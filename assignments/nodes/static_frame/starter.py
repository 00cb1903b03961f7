import rclpy
from rclpy.node import Node


class StaticFrame(Node):
    def __init__(self):
        super().__init__('static_frame')
        # TODO: a StaticTransformBroadcaster and a TransformStamped


def main():
    rclpy.init()
    node = StaticFrame()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
