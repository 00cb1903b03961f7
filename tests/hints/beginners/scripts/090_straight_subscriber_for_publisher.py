import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class StraightMover(Node):
    def __init__(self):
        super().__init__('straight_mover')
        self.cmd = self.create_subscription(Twist, '/turtle1/cmd_vel', self.timer_callback, 10)
        self.timer = self.create_timer(0.1, self.send)

    def timer_callback(self, msg):
        self.get_logger().info(f'收到 {msg.linear.x}')

    def send(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.cmd.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(StraightMover())


if __name__ == '__main__':
    main()
