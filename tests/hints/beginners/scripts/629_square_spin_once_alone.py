import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareTimer(Node):
    def __init__(self):
        super().__init__('square_timer')
        self.publisher = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.02, self.tick)
        self.state = 'forward'
        self.count = 0
        self.sides = 0

    def tick(self):
        msg = Twist()
        if self.state == 'forward':
            msg.linear.x = 1.0
            self.count += 1
            if self.count >= 100:
                self.count = 0
                self.state = 'turn'
        elif self.state == 'turn':
            msg.angular.z = 1.0
            self.count += 1
            if self.count >= 79:
                self.count = 0
                self.sides += 1
                self.state = 'forward'
                if self.sides == 4:
                    self.state = 'stop'
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = SquareTimer()
    rclpy.spin_once(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
