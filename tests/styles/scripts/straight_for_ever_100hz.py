import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Node100(Node):
    def __init__(self):
        super().__init__('node100')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.01, self.on_timer)
        self.msg = Twist()
        self.msg.linear.x = 0.25

    def on_timer(self):
        self.publisher.publish(self.msg)


def main(args=None):
    rclpy.init(args=args)
    node = Node100()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
