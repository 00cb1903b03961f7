import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class TriangleMover(Node):
    def __init__(self):
        super().__init__('triangle_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/pose', 10)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = TriangleMover()
    time.sleep(1)
    for i in range(3):
        node.go(1.0, 0.0, 2.0)
        node.go(0.0, 1.0, 2.094)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
