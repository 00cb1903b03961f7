import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.count = 0
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        if self.count < 20:
            msg.linear.x = -1.0
        elif self.count < 40:
            msg.linear.x = 1.0     # 回到原来的位置
        self.pub.publish(msg)
        self.count += 1


def main():
    rclpy.init()
    node = Backward()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
