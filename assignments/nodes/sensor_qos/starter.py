import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Bool


class NearGuard(Node):
    def __init__(self):
        super().__init__('near_guard')
        self.publisher = self.create_publisher(Bool, 'near', 10)
        self.subscription = self.create_subscription(Range, 'range', self.on_range, 10)

    def on_range(self, msg):
        pass  # TODO


def main():
    rclpy.init()
    node = NearGuard()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
