import threading
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.flag = True
        self.worker = threading.Thread(target=self.loop, daemon=True)
        self.worker.start()

    def loop(self):
        while self.flag:
            m = Twist()
            m.angular.z = 2.0
            self.pub.publish(m)
            time.sleep(0.1)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = Spinner()
    time.sleep(8)
    node.flag = False
    node.worker.join()
    time.sleep(0.2)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
