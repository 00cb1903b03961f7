import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class BackwardMover(Node):
    def __init__(self):
        super().__init__('backward_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, timer_callback)

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = -0.5
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = BackwardMover()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
