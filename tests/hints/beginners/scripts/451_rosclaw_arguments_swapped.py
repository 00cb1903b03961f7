import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class D(Node):
    def __init__(self):
        super().__init__('d')
        self.srv = self.create_service(GetCapabilities, self.hui, '/rosclaw/get_capabilities')

    def hui(self, request, response):
        response.capabilities = ['navigation', 'camera']
        return response


def main():
    rclpy.init()
    rclpy.spin(D())


main()
