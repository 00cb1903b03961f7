import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class ParamSquare(Node):

    def __init__(self):
        super().__init__('param_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.side = self.declare_parameter('side', 2.0).value
        self.get_logger().info(f'边长参数 side = {self.side}')

    def act(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def draw(self):
        for i in range(4):
            self.act(1.0, 0.0, self.side / 1.0)
            self.act(0.0, 1.0, math.pi / 2)


def main(args=None):
    rclpy.init(args=args)
    node = ParamSquare()
    time.sleep(1)
    node.draw()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
