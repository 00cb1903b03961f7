import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

def tick(self):
    msg = Twist()
    msg.linear.x = -1.0
    self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Backward()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
