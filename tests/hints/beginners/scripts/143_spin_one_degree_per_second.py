import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    TURN_SPEED = 1.0      # rad/s

    def __init__(self):
        super().__init__('spinner')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.angular.z = math.radians(self.TURN_SPEED)
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Spinner()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
