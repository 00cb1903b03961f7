import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.TURN_SPEED = 1.0
        self.SIDE_LENGTH = 2.0
        self.MOVE_TIME = self.SIDE_LENGTH / self.SPEED
        self.TURN_TIME = 90 / self.TURN_SPEED      # 90°

    def run_cmd(self, v, w, duration):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.run_cmd(self.SPEED, 0.0, self.MOVE_TIME)
            self.run_cmd(0.0, self.TURN_SPEED, self.TURN_TIME)


def main(args=None):
    rclpy.init(args=args)
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
