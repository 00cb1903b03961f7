import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Go(Node):
    def __init__(self):
        super().__init__('go')
        self.pub = self.create_publisher('/turtle1/cmd_vel', Twist, 10)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        twist = Twist()
        twist.linear.x = 0.5
        self.pub.publish(twist)


def main():
    rclpy.init()
    go = Go()
    try:
        rclpy.spin(go)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
