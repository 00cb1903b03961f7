import rclpy
from rclpy.node import Node
from turtlesim.msg import Pose


class TurtleFrame(Node):
    def __init__(self):
        super().__init__('turtle_frame')
        # TODO: a TransformBroadcaster, and a subscription to /turtle1/pose


def main():
    rclpy.init()
    node = TurtleFrame()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
