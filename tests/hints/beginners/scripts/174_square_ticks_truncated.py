import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

PERIOD = 0.1
DRIVE_TICKS = int(2.0 / PERIOD)
TURN_TICKS = int(1.5708 / PERIOD)


class SquareByTimer(Node):
    def __init__(self):
        super().__init__('square_by_timer')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.k = -10
        self.timer = self.create_timer(PERIOD, self.tick)

    def tick(self):
        msg = Twist()
        one = DRIVE_TICKS + TURN_TICKS
        if 0 <= self.k < 4 * one:
            if self.k % one < DRIVE_TICKS:
                msg.linear.x = 1.0
            else:
                msg.angular.z = 1.0
        self.pub.publish(msg)
        self.k += 1


def main():
    rclpy.init()
    node = SquareByTimer()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == '__main__':
    main()
