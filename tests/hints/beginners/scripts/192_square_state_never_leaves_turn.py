import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class FSM(Node):
    def __init__(self):
        super().__init__('fsm')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.state = 'drive'
        self.start = self.get_clock().now()
        self.corner = 0
        self.timer = self.create_timer(0.02, self.update)

    def elapsed(self):
        return (self.get_clock().now() - self.start).nanoseconds / 1e9

    def update(self):
        msg = Twist()
        if self.state == 'drive':
            msg.linear.x = 1.0
            if self.elapsed() > 2.0:
                self.state = 'turn'
                self.start = self.get_clock().now()
        elif self.state == 'turn':
            msg.angular.z = 1.0
            if self.elapsed() > 1.5708:
                self.corner += 1
                self.start = self.get_clock().now()
                # 下一条边
                if self.corner == 4:
                    self.state = 'done'
                    # TODO
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = FSM()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
