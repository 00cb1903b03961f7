import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class PolygonNode(Node):
    """参数 sides、length；默认就是三角形"""

    def __init__(self):
        super().__init__('polygon_node')
        self.declare_parameters('', [('sides', 3), ('length', 2.0), ('speed', 1.0)])
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def hold(self, v, w, seconds, hz=50):
        rate = self.create_rate(hz)
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        for _ in range(round(seconds * hz)):
            self.pub.publish(msg)
            rate.sleep()
        self.destroy_rate(rate)

    def draw(self):
        n = self.get_parameter('sides').value
        a = self.get_parameter('length').value
        v = self.get_parameter('speed').value
        self.hold(0.0, 0.0, 1.0)
        for k in range(n):
            self.hold(v, 0.0, a / v)
            self.hold(0.0, 0.0, 0.1)
            self.hold(0.0, 2 * math.pi / n / 2.0, 2.0)
            self.hold(0.0, 0.0, 0.1)


def main():
    rclpy.init()
    node = PolygonNode()
    spinner = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    spinner.start()
    node.draw()
    rclpy.shutdown()
    spinner.join(timeout=1.0)


if __name__ == '__main__':
    main()
