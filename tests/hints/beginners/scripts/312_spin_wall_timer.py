import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.publisher_ = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer_ = self.create_wall_timer(0.1, self.timer_callback)

    def timer_callback(self):
        message = Twist()
        message.angular.z = 1.0
        self.publisher_.publish(message)


def main():
    rclpy.init()
    rclpy.spin(Spinner())


if __name__ == '__main__':
    main()
