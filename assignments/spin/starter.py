"""让小乌龟原地转一圈。把 TODO 补全。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        # TODO: 设置角速度 msg.angular.z（浮点数，单位 rad/s），转满一圈
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Spinner()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
