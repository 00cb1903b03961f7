import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Sq(Node):
    """定时器写法，右转"""

    def __init__(self):
        super().__init__('sq')
        self.declare_parameter('side', 2.0)
        side = self.get_parameter('side').get_parameter_value().double_value
        pause = [(0.0, 0.0, 0.1)]
        self.plan = [(0.0, 0.0, 1.0)]
        for _ in range(4):
            self.plan += [(1.0, 0.0, side)] + pause + [(0.0, -0.7854, 2.0)] + pause
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.end = self.sec() + self.plan[0][2]
        self.timer = self.create_timer(0.01, self.tick)

    def sec(self):
        return self.get_clock().now().nanoseconds / 1e9

    def tick(self):
        m = Twist()
        if self.plan:
            m.linear.x, m.angular.z, _ = self.plan[0]
            if self.sec() >= self.end:
                self.plan.pop(0)
                if self.plan:
                    self.end += self.plan[0][2]
        self.pub.publish(m)


def main():
    rclpy.init()
    try:
        rclpy.spin(Sq())
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
