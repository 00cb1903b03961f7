import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Shut(Node):
    def __init__(self):
        super().__init__('shut')
        self.n = 0
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.cb)

    def cb(self):
        self.n += 1
        msg = Twist()
        msg.angular.z = 1.0 if self.n <= 20 else 0.0
        self.pub.publish(msg)
        if self.n == 21:
            self.destroy_node()
            rclpy.shutdown()


def main():
    rclpy.init()
    node = Shut()
    rclpy.spin(node)
    print('after spin', rclpy.ok())


main()
