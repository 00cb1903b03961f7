import threading
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.worker = threading.Thread(target=self.run, daemon=True)
        self.worker.start()

    def run(self):
        for v, w, d in [(1.0, 0.0, 1.5), (0.0, 1.0, 1.0), (1.0, 0.0, 1.5)]:
            t = Twist()
            t.linear.x = v
            t.angular.z = w
            end = time.time() + d
            while time.time() < end:
                self.pub.publish(t)
                time.sleep(0.05)
        self.pub.publish(Twist())
        self.get_logger().info('thread done')


def main():
    rclpy.init()
    node = Driver()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


main()
