import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def act(self, v, w, duration):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start = self.get_clock().now()
        while (self.get_clock().now() - start).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.act(1.0, 0.0, 2.0)
            self.act(0.0, 1.0, 1.5708)


def main(args=None):
    rclpy.init(args=args)
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
