import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
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
    node = Square()
    for i in range(4):
        node.drive(1.0, 0.0, 2.0)
        node.drive(0.0, 1.0, 1.5708)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
