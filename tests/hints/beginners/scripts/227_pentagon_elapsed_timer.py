import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    """定时器 + 经过的时间 => 应该做什么"""

    N = 5
    SIDE_T = 2.0
    TURN_T = 1.0
    PAUSE = 0.1

    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.t0 = self.get_clock().now()
        self.create_timer(0.01, self.tick)

    def tick(self):
        t = (self.get_clock().now() - self.t0).nanoseconds * 1e-9 - 1.0
        msg = Twist()
        period = self.SIDE_T + self.TURN_T + 2 * self.PAUSE
        if 0 <= t < self.N * period:
            r = t % period
            if r < self.SIDE_T:
                msg.linear.x = 0.9
            elif self.SIDE_T + self.PAUSE <= r < self.SIDE_T + self.PAUSE + self.TURN_T:
                msg.angular.z = math.radians(72) / self.TURN_T
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Pentagon()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        node.get_logger().info('用户停止')


if __name__ == '__main__':
    main()
