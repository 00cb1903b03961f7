import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Fang(Node):
    def __init__(self):
        super().__init__('fang')
        self.declare_parameter('side', 2.0)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = 1.0

    def run(self):
        side = self.get_parameter('side')
        for i in range(4):
            self.go(self.speed, 0.0, side / self.speed)
            self.go(0.0, 1.0, 1.5708)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    f = Fang()
    time.sleep(1)
    f.run()
    f.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
