import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.SIDE_LENGTH = 2.0
        self.MOVE_TIME = self.SIDE_LENGTH / self.SPEED
        self.TURN_TIME = 1.5708

    def act(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.act(self.SPEED, 0.0, self.MOVE_TIME)
            self.act(0.0, 1.0, self.TURN_TIME)


def main():
    rclpy.init()
    node = SquareMover()
    side = input("请输入边长(米): ")
    node.SIDE_LENGTH = float(side)
    time.sleep(1)
    node.move_square()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
