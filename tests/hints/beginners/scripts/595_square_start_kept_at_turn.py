import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.02, self.update)
        self.start_time = self.get_clock().now()
        self.turning = False
        self.corner = 0

    def update(self):
        elapsed = (self.get_clock().now() - self.start_time).nanoseconds / 1e9
        cmd = Twist()
        if self.corner >= 4:
            self.pub.publish(cmd)
            self.timer.cancel()
            return
        if not self.turning:
            cmd.linear.x = 1.0
            if elapsed >= 2.0:
                self.turning = True
        else:
            cmd.angular.z = 1.0
            if elapsed >= math.pi / 2:
                self.turning = False
                self.corner += 1
                self.start_time = self.get_clock().now()
        self.pub.publish(cmd)


def main():
    rclpy.init()
    node = Square()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
