"""后退 2 米后停下：线速度取负值。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)
        self.ticks = 0

    def tick(self):
        self.ticks += 1
        msg = Twist()
        if self.ticks <= 20:
            msg.linear.x = -1.0
            msg.angular.z = 0.0
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Backward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
