"""用摄像头沿线行驶：在图像下半部分找深色像素。"""

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Image

DARK = 90  # 比这更暗的像素是线
SPEED = 0.12  # m/s


class LineFollower(Node):
    def __init__(self):
        super().__init__('line_follower')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(Image, '/camera/image_raw', self.on_image, 10)

    def on_image(self, image):
        picture = np.frombuffer(bytes(image.data), np.uint8).reshape(image.height, image.width, 3)
        near = picture[40:, :, :].max(axis=2)  # 下面 20 行
        columns = np.nonzero(near > DARK)[1]
        msg = Twist()
        if len(columns) > 3:
            offset = columns.mean() / image.width - 0.5  # -0.5 在最左，0.5 在最右
            msg.linear.x = SPEED
            msg.angular.z = -2.5 * float(offset)
        self.publisher.publish(msg)


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
