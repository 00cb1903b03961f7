import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Turtle(Node):
    def __init__(self):
        super().__init__('turtle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.move())

    def move(self):
        msg = Twist()
        msg.linear.x = 1.0
        msg.angular.z = 0.0
        self.pub.publish(msg)
        self.get_logger().info('移动中...')


def main(args=None):
    rclpy.init(args=args)
    node = Turtle()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
