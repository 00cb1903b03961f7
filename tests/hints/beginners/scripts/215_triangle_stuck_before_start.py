import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class TriangleMover(Node):
    def __init__(self):
        super().__init__('triangle_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.get_logger().info('三角形节点启动')

    def act(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def move_triangle(self):
        for i in range(3):
            self.act(1.0, 0.0, 2.0)
            self.act(0.0, 1.0, 2.094)


def main(args=None):
    rclpy.init(args=args)
    node = TriangleMover()
    rclpy.spin(node)
    node.move_triangle()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
