import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from math import pi


class Walker(Node):
    def __init__(self):
        super().__init__('walker')
        self.cmd = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.start = self.get_clock().now()
        self.step = 0
        self.create_timer(0.01, self.update)

    def update(self):
        passed = (self.get_clock().now() - self.start).nanoseconds / 1e9
        msg = Twist()
        if self.step >= 8:
            self.cmd.publish(msg)
            return
        if self.step % 2 == 0:
            msg.linear.x = 1.5
            limit = 2.0 / 1.5
        else:
            msg.angular.z = 0.8
            limit = (pi / 2) / 0.8
        if passed < limit:
            self.cmd.publish(msg)
        else:
            self.cmd.publish(Twist())
            self.step += 1


def main():
    rclpy.init()
    walker = Walker()
    rclpy.spin(walker)


if __name__ == '__main__':
    main()
