import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class TriangleTimer(Node):
    def __init__(self):
        super().__init__('triangle_timer')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.steps = [(0.0, 0.0)] * 10 + ([(1.0, 0.0)] * 20 + [(0.0, 1.0472)] * 20) * 3
        self.i = 0
        self.timer = self.create_timer(0.1, self.next_step)

    def next_step(self):
        msg = Twist()
        if self.i < len(self.steps):
            msg.linear.x, msg.angular.z = self.steps[self.i]
            self.i += 1
        self.timer.cancel()     # 走完了取消定时器
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = TriangleTimer()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
