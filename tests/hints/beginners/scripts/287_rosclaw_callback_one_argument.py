import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class Discovery(Node):
    def __init__(self):
        super().__init__('rosclaw_discovery')
        self.srv = self.create_service(GetCapabilities, '/rosclaw/get_capabilities', self.on_request)

    def on_request(self, request):
        response = GetCapabilities.Response()
        response.capabilities = ['navigation', 'camera']
        return response


def main():
    rclpy.init()
    node = Discovery()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
