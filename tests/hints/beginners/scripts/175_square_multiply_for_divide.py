import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 0.5
        self.TURN_SPEED = 0.5
        self.SIDE = 2.0
        self.MOVE_TIME = self.SIDE * self.SPEED
        self.TURN_TIME = 1.5708 * self.TURN_SPEED

    def cmd(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        t0 = time.time()
        while time.time() - t0 < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    for i in range(4):
        node.cmd(node.SPEED, 0.0, node.MOVE_TIME)
        node.cmd(0.0, node.TURN_SPEED, node.TURN_TIME)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
