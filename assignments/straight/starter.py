"""让小乌龟前进。把 TODO 补全。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        # TODO: 设置前进的线速度 msg.linear.x（浮点数，单位 m/s）
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Forward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
