import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
        # 停止，不然会撞墙
        stop = Twist()
        stop.linear.x = 0.0
        self.pub.publish(stop)


def main():
    rclpy.init()
    node = Forward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == '__main__':
    main()
