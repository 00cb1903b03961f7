import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SlowTurtle(Node):
    def __init__(self):
        super().__init__('slow_turtle')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = 0.02  # 乌龟慢慢爬
        self.cmd_vel_pub.publish(msg)


def main():
    rclpy.init()
    node = SlowTurtle()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
