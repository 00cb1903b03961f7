import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.run()
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self):
        for i in range(5):
            self.go(1.0, 0.0, 2.0)
            self.go(0.0, 1.0, 1.257)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = Pentagon()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
