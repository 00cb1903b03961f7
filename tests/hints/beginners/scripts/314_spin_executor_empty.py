import rclpy
from rclpy.node import Node
from rclpy.executors import SingleThreadedExecutor
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        m = Twist()
        m.angular.z = 1.0
        self.pub.publish(m)


def main():
    rclpy.init()
    node = Spinner()
    executor = SingleThreadedExecutor()
    executor.spin()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
