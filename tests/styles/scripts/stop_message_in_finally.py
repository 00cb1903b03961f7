import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.2, self.cb)

    def cb(self):
        msg = Twist()
        msg.linear.x = 0.4
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Mover()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        node.get_logger().info('Ctrl+C')
    finally:
        node.pub.publish(Twist())
        node.destroy_node()
        rclpy.shutdown()


if __name__ == '__main__':
    main()
