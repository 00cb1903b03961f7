import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class WuBian(Node):
    def __init__(self):
        super().__init__('wubian')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def dong(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(1)        # 休息一下


def main():
    rclpy.init()
    w = WuBian()
    time.sleep(1)
    for i in range(5):
        w.dong(1.0, 0.0, 1.5)
        w.dong(0.0, 1.0, 1.25)
    w.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
