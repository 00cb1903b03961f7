import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class ForwardNode(Node):
    """速度可以用参数 speed 设置，默认 1.0"""

    def __init__(self):
        super().__init__('forward_node')
        self.declare_parameter('speed', 1.0)
        self.declare_parameter('period', 0.05)
        self.publisher_ = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        period = self.get_parameter('period').value
        self.timer_ = self.create_timer(period, self.on_timer)

    def on_timer(self):
        v = self.get_parameter('speed').value
        self.publisher_.publish(Twist(linear=Vector3(x=v, y=0.0, z=0.0)))


def main(args=None):
    rclpy.init(args=args)
    node = ForwardNode()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
