import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def straight(self):
        self.send(1.0, 0.0, 1.0)

    def turn(self):
        self.send(0.5, 0.6283, 2.0)     # 边走边转，省时间

    def send(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)


def main():
    rclpy.init()
    p = Pentagon()
    time.sleep(1)
    for i in range(5):
        p.straight()
        p.turn()
    p.send(0.0, 0.0, 0.2)
    p.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
