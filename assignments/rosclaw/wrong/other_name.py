"""服务名称少了前缀 /rosclaw。"""

import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class Discovery(Node):
    def __init__(self):
        super().__init__('rosclaw_discovery')
        self.service = self.create_service(GetCapabilities, '/get_capabilities', self.handle_get_capabilities)
        self.get_logger().info('RosClaw Discovery Node 已启动')

    def handle_get_capabilities(self, request, response):
        """返回机器人的能力列表。"""
        response.capabilities = ['navigation', 'camera', 'speak', 'battery']
        return response


def main():
    rclpy.init()
    node = Discovery()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
