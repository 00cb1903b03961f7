import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Houtui(Node):
    def __init__(self):
        super().__init__('houtui')
        self.fabuzhe = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.dingshiqi = self.create_timer(0.1, self.fasong)

    def fasong(self):
        xx = Twist()
        xx.linear.x = '-1.0'
        self.fabuzhe.publish(xx)


def main():
    rclpy.init()
    jd = Houtui()
    rclpy.spin(jd)
    jd.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
