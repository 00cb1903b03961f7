"""A QoS mismatch mended."""

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Range
from std_msgs.msg import Bool


class NearGuard(Node):
    def __init__(self):
        super().__init__('near_guard')
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.publisher = self.create_publisher(Bool, 'near', 10)
        self.subscription = self.create_subscription(Range, 'range', self.on_range, qos)

    def on_range(self, msg):
        near = Bool()
        near.data = msg.range < 0.5
        self.publisher.publish(near)


def main():
    rclpy.init()
    node = NearGuard()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
