import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Wu(Node):
    def __init__(self):
        super().__init__('wu')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    wu = Wu()
    time.sleep(0.5)
    for bian in range(4):
        wu.drive(1.0, 0.0, 2.0)
        wu.drive(0.0, 0.6283, 2.0)
    wu.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
