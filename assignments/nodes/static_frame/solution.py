"""A static frame."""

import rclpy
from rclpy.node import Node
import math

from geometry_msgs.msg import TransformStamped
from tf2_ros import StaticTransformBroadcaster


class StaticFrame(Node):
    def __init__(self):
        super().__init__('static_frame')
        self.broadcaster = StaticTransformBroadcaster(self)
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = 'base_link'
        t.child_frame_id = 'laser'
        t.transform.translation.x = 0.2
        t.transform.translation.z = 0.3
        yaw = math.radians(90)
        t.transform.rotation.z = math.sin(yaw / 2)
        t.transform.rotation.w = math.cos(yaw / 2)
        self.broadcaster.sendTransform(t)


def main():
    rclpy.init()
    node = StaticFrame()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
