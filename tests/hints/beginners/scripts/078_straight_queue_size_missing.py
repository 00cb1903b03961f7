import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class StraightMover(Node):
    def __init__(self):
        super().__init__('straight_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel')
        self.timer = self.create_timer(0.2, self.step)

    def step(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = StraightMover()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
