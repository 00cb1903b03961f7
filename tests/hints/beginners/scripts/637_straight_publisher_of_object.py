import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Forward(Node):
    def __init__(self):
        super().__init__('forward_node')
        self.pub = self.create_publisher(Twist(), '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.go)
        self.n = 0

    def go(self):
        cmd = Twist()
        if self.n < 30:
            cmd.linear.x = 1.0
        self.pub.publish(cmd)
        self.n += 1


def main():
    rclpy.init()
    node = Forward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
