import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Gappy(Node):
    def __init__(self):
        super().__init__('gappy')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.create_timer(1.5, self.cb)

    def cb(self):
        self.n += 1
        if self.n > 3:
            rclpy.shutdown()
            return
        t = Twist()
        t.linear.x = 1.0
        self.pub.publish(t)
        self.get_logger().info('push %d' % self.n)


def main():
    rclpy.init()
    node = Gappy()
    rclpy.spin(node)
    node.destroy_node()


main()
