import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)
        self.sec = 0

    def tick(self):
        self.sec += 1
        msg = Twist()
        if self.sec <= 10:       # 10秒肯定够一圈了
            msg.angular.z = 1.0
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Spinner()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
