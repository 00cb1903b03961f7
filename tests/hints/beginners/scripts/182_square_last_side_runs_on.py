import rclpy
import time
import math
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Runner(Node):
    def __init__(self):
        super().__init__('runner')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, sec):
        cmd = Twist()
        cmd.linear.x = v
        cmd.angular.z = w
        limit = time.time() + sec
        while time.time() < limit:
            self.p.publish(cmd)
            time.sleep(0.01)


if __name__ == '__main__':
    rclpy.init()
    r = Runner()
    time.sleep(1)
    for n in range(4):
        r.go(0.0, math.pi / 2, 1.0)
        r.go(1.5, 0.0, 1.5)
    r.destroy_node()
    rclpy.shutdown()
