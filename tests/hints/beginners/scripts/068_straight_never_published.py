import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = 1.0
        msg.angular.z = 0.0
        self.get_logger().info('Published: linear.x=1.0')


def main():
    rclpy.init()
    node = Forward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
