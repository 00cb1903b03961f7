import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class TriangleMover(Node):
    """走三角形：等边三角形每个角60度"""

    def __init__(self):
        super().__init__('triangle_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.MOVE_TIME = 2.0
        self.TURN_TIME = 1.047     # 60° = π/3

    def act(self, v, w, duration):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_triangle(self):
        for i in range(3):
            self.act(1.0, 0.0, self.MOVE_TIME)
            self.act(0.0, 1.0, self.TURN_TIME)


def main(args=None):
    rclpy.init(args=args)
    node = TriangleMover()
    time.sleep(1)
    node.move_triangle()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
