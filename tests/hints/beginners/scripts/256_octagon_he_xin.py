"""八边形，顺时针。何鑫"""
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

SPEED = 1.5
TURN_SPEED = 1.2
TURN_TIME = 0.7854 / TURN_SPEED
SIDE = 1.0


class Bajiao(Node):
    def __init__(self):
        super().__init__('bajiao')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.cmd = Twist()

    def keep(self, seconds):
        start = time.time()
        while time.time() - start < seconds:
            self.pub.publish(self.cmd)
            time.sleep(0.01)
        self.cmd = Twist()
        self.pub.publish(self.cmd)
        time.sleep(0.1)

    def straight(self):
        self.cmd.linear.x = SPEED
        self.keep(SIDE / SPEED)

    def right(self):
        self.cmd.angular.z = -TURN_SPEED
        self.keep(TURN_TIME)


def main():
    rclpy.init()
    b = Bajiao()
    time.sleep(1)
    for i in range(8):
        b.straight()
        b.right()
    b.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
