# 倒车 —— 赵磊
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class BackNode(Node):
    def __init__(self):
        super().__init__('back_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.daoche)
        self.get_logger().info('倒车，请注意！')

    def daoche(self):
        msg = Twist()
        msg.linear.x = -1.0
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = BackNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
