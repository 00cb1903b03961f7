import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Sleeper(Node):
    """The whole figure is driven inside one timer callback, with sleeps."""

    def __init__(self):
        super().__init__('sleeper')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.5, self.cb)
        self.step = 0

    def cb(self):
        msg = Twist()
        if self.step % 2 == 0:
            msg.linear.x = 1.0
        else:
            msg.angular.z = 1.57
        self.pub.publish(msg)
        time.sleep(0.9)
        self.pub.publish(Twist())
        self.step += 1
        if self.step == 4:
            rclpy.shutdown()


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Sleeper())


if __name__ == '__main__':
    main()
