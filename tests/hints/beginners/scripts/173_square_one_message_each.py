import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Once(Node):
    def __init__(self):
        super().__init__('once')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def forward(self):
        m = Twist()
        m.linear.x = 1.0
        self.pub.publish(m)
        time.sleep(2.0)

    def left(self):
        m = Twist()
        m.angular.z = 1.0
        self.pub.publish(m)
        time.sleep(1.5708)


def main():
    rclpy.init()
    o = Once()
    time.sleep(1)
    for i in range(4):
        o.forward()
        o.left()
    o.pub.publish(Twist())
    time.sleep(0.2)
    o.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
