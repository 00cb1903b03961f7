import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.timer = self.create_timer(0.2, self.tick)

    def tick(self):
        pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        msg = Twist()
        msg.angular.z = 1.0
        pub.publish(msg)
        self.destroy_publisher(pub)


def main():
    rclpy.init()
    node = Spinner()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
