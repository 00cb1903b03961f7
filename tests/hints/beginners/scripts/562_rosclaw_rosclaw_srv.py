import rclpy
from rclpy.node import Node
from rosclaw.srv import GetCapabilities


class Disc(Node):
    def __init__(self):
        super().__init__('disc')
        self.srv = self.create_service(GetCapabilities, '/rosclaw/get_capabilities', self.cb)

    def cb(self, request, response):
        response.capabilities = ['move', 'turn']
        return response


def main():
    rclpy.init()
    rclpy.spin(Disc())


main()
