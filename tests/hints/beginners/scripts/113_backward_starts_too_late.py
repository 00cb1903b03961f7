import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def back(self, seconds):
        m = Twist()
        m.linear.x = -1.0
        for i in range(int(seconds * 10)):
            self.pub.publish(m)
            time.sleep(0.1)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = Backward()
    time.sleep(30)    # 等待 turtlesim 完全启动
    node.back(2)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
