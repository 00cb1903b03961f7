import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def cmd(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = self.get_clock().now()
        while (self.get_clock().now() - s).nanoseconds < t * 1e9:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = SquareMover()
    for i in range(4):
        node.cmd(1.0, 0.0, 2.0)
        node.cmd(0.0, 1.0, 1.5708)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
