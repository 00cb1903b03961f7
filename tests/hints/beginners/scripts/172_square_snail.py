import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Snail(Node):
    SPEED = 0.15
    TURN = 0.5
    SIDE = 3.0

    def __init__(self):
        super().__init__('snail')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def send(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        t0 = time.time()
        while time.time() - t0 < t:
            self.pub.publish(m)
            time.sleep(0.05)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def square(self):
        for i in range(4):
            self.send(self.SPEED, 0.0, self.SIDE / self.SPEED)
            self.send(0.0, self.TURN, 1.5708 / self.TURN)


def main():
    rclpy.init()
    s = Snail()
    time.sleep(1)
    s.square()
    s.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
