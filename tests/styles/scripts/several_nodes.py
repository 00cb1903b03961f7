import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_msgs.msg import String


class Brain(Node):
    def __init__(self):
        super().__init__('brain')
        self.pub = self.create_publisher(String, 'orders', 10)
        self.orders = ['forward'] * 4 + ['left'] * 2 + ['forward'] * 2 + ['stop']
        self.create_timer(0.5, self.think)

    def think(self):
        if self.orders:
            self.pub.publish(String(data=self.orders.pop(0)))


class Legs(Node):
    TABLE = {'forward': (1.0, 0.0), 'left': (0.0, 1.0), 'stop': (0.0, 0.0)}

    def __init__(self):
        super().__init__('legs')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(String, '/orders', self.obey, 10)

    def obey(self, order):
        msg = Twist()
        msg.linear.x, msg.angular.z = self.TABLE[order.data]
        self.pub.publish(msg)
        self.get_logger().info(f'I heard: "{order.data}"')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    nodes = [Brain(), Legs()]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()


if __name__ == '__main__':
    main()
