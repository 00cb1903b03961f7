import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Param(Node):
    def __init__(self):
        super().__init__('param_node')
        self.declare_parameter('speed', 1.0)
        self.declare_parameter('ticks', 10)
        self.declare_parameters('', [('turn', 0.0), ('label', 'none')])
        self.speed = self.get_parameter('speed').value
        self.ticks = self.get_parameter('ticks').get_parameter_value().integer_value
        self.turn = self.get_parameter('turn').get_parameter_value().double_value
        self.get_logger().info(f"{self.get_name()} {self.speed} {self.ticks} {self.get_parameter('label').value}")
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        if self.ticks > 0:
            self.ticks -= 1
            msg.linear.x = self.speed
            msg.angular.z = self.turn
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Param()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
