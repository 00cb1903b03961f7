"""Number counter."""

import rclpy
from rclpy.node import Node
from example_interfaces.msg import Int64
from example_interfaces.srv import SetBool


class NumberCounter(Node):
    def __init__(self):
        super().__init__('number_counter')
        self.total = 0
        self.publisher = self.create_publisher(Int64, 'number_count', 10)
        self.subscription = self.create_subscription(Int64, 'number', self.on_number, 10)
        self.service = self.create_service(SetBool, 'reset_counter', self.on_reset)

    def on_number(self, msg):
        self.total += msg.data
        answer = Int64()
        answer.data = self.total
        self.publisher.publish(answer)

    def on_reset(self, request, response):
        if request.data:
            self.total = 0
            response.success = True
            response.message = 'reset'
        else:
            response.success = False
            response.message = 'not reset'
        return response


def main():
    rclpy.init()
    node = NumberCounter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
