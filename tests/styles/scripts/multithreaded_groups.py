import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Groups(Node):
    def __init__(self):
        super().__init__('groups')
        self.w = 0.0
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.05, self.fast, callback_group=MutuallyExclusiveCallbackGroup())
        self.slow_timer = self.create_timer(1.0, self.slow, callback_group=ReentrantCallbackGroup())

    def fast(self):
        msg = Twist()
        msg.linear.x = 0.5
        msg.angular.z = self.w
        self.pub.publish(msg)

    def slow(self):
        self.slow_timer.cancel()
        time.sleep(1.0)  # the fast timer goes on meanwhile
        self.w = 0.5
        time.sleep(2.0)
        self.get_logger().info('slow callback ends')
        rclpy.shutdown()


def main():
    rclpy.init()
    node = Groups()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        executor.shutdown()
        node.destroy_node()


if __name__ == '__main__':
    main()
