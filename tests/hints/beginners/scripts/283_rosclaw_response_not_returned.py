import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class RosClawDiscovery(Node):
    def __init__(self):
        super().__init__('rosclaw_discovery')
        self.srv = self.create_service(
            GetCapabilities, '/rosclaw/get_capabilities', self.handle_get_capabilities)

    def handle_get_capabilities(self, request, response):
        response.capabilities = ['navigation', 'camera']


def main():
    rclpy.init()
    node = RosClawDiscovery()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
