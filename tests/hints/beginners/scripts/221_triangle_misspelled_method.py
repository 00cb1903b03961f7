import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Triangle(Node):
    def __init__(self):
        super().__init__('triangle')
        self.pub = self.create_publiser(Twist, '/turtle1/cmd_vel', 10)

    def step(self, lin, ang, dur):
        cmd = Twist()
        cmd.linear.x = lin
        cmd.angular.z = ang
        t = time.time() + dur
        while time.time() < t:
            self.pub.publish(cmd)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = Triangle()
    time.sleep(1)
    for side in range(3):
        node.step(1.0, 0.0, 2.0)
        node.step(0.0, 1.0, 2.094)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
