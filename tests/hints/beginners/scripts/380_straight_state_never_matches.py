import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Zhixing(Node):
    def __init__(self):
        super().__init__('zhixing')
        self.state = 'go'
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.loop)

    def loop(self):
        if self.state == 'GO':
            m = Twist()
            m.linear.x = 1.0
            self.pub.publish(m)


def main():
    rclpy.init()
    rclpy.spin(Zhixing())


main()
