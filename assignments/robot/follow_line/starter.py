"""用摄像头沿线行驶：补上 TODO。"""

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Image

DARK = 90  # 比这更暗的像素是线


class LineFollower(Node):
    def __init__(self):
        super().__init__('line_follower')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(Image, '/camera/image_raw', self.on_image, 10)

    def on_image(self, image):
        picture = np.frombuffer(bytes(image.data), np.uint8).reshape(image.height, image.width, 3)
        near = picture[40:, :, :].max(axis=2)  # 下面 20 行
        columns = np.nonzero(near < DARK)[1]
        # TODO: 根据 columns（深色像素的列号）决定速度，再发布 msg
        self.get_logger().info(f'{len(columns)}')


def main():
    rclpy.init()
    node = LineFollower()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
