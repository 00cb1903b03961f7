import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Busy(Node):
    def __init__(self):
        super().__init__('busy')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start = self.get_clock().now()
        while (self.get_clock().now() - start).nanoseconds < seconds * 1e9:
            self.pub.publish(msg)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    node = Busy()
    for _ in range(2):
        node.drive(1.0, 0.0, 1.0)
        node.drive(0.0, 1.5708, 1.0)
    node.destroy_node()
    rclpy.shutdown()


main()
