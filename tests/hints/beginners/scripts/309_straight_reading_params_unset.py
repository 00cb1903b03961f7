import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from geometry_msgs.msg import Twist


class ParamStraight(Node):
    def __init__(self):
        super().__init__('param_straight')
        self.declare_parameter('speed', Parameter.Type.DOUBLE)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        msg = Twist()
        msg.linear.x = self.get_parameter('speed').value
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(ParamStraight())


if __name__ == '__main__':
    main()
