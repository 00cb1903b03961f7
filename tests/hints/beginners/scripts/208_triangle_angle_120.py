import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Triangle(Node):
    def __init__(self):
        super().__init__('triangle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.vel = Twist()

    def forward(self, sec):
        self.vel.linear.x = 1.0
        self.vel.angular.z = 0.0
        self.keep(sec)

    def left(self, degree):
        self.vel.linear.x = 0.0
        self.vel.angular.z = float(degree)
        self.keep(1.0)

    def keep(self, sec):
        t = time.time() + sec
        while time.time() < t:
            self.pub.publish(self.vel)
            time.sleep(0.02)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    t = Triangle()
    time.sleep(1)
    for i in range(3):
        t.forward(2)
        t.left(120)
    t.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
