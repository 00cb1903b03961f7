import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class RosClawDiscovery(Node):
    def __init__(self):
        super().__init__('rosclaw_discovery')
        self.srv = self.create_service(
            GetCapabilities, '/rosclaw/get_capabilities', self.handle)
        self.get_logger().info('RosClaw Discovery Node 已启动')

    def handle(self, request, response):
        response.capabilities = ['navigation', 'camera', 'speak', 'battery']
        return response


def main(args=None):
    rclpy.init(args=args)
    node = RosClawDiscovery()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
