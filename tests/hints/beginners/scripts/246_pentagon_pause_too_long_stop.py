import os
import threading
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def kill():
    # 防止程序卡死
    print('时间到')
    os._exit(0)


def main():
    rclpy.init()
    threading.Timer(8.0, kill).start()
    node = Pentagon()
    time.sleep(1)
    for i in range(5):
        node.go(1.0, 0.0, 2.0)
        node.go(0.0, 1.0, 1.257)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
