import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class BackwardMover(Node):
    """控制小乌龟后退的节点"""

    def __init__(self):
        super().__init__('backward_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)
        self.get_logger().info('后退控制节点已启动!')

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = 1.0    # 后退 1 m/s
        msg.angular.z = 0.0   # 不旋转
        self.cmd_vel_pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = BackwardMover()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
