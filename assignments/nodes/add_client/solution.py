"""Client for sums."""

import rclpy
from rclpy.node import Node
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point
from std_msgs.msg import Int64


class AddClient(Node):
    def __init__(self):
        super().__init__('add_client')
        self.client = self.create_client(AddTwoInts, 'add_two_ints')
        self.publisher = self.create_publisher(Int64, 'sum', 10)
        self.subscription = self.create_subscription(Point, 'pair', self.on_pair, 10)

    def on_pair(self, msg):
        request = AddTwoInts.Request()
        request.a = int(msg.x)
        request.b = int(msg.y)
        future = self.client.call_async(request)
        future.add_done_callback(self.on_answer)

    def on_answer(self, future):
        msg = Int64()
        msg.data = future.result().sum
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = AddClient()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
