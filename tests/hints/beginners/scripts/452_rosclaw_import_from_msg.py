#!/usr/bin/env python3
"""
RosClaw Discovery Node - 自动发现ROS2能力
"""

import rclpy
from rclpy.node import Node
from rosclaw_msgs.msg import GetCapabilities, CallService, PublishMessage

class RosClawDiscovery(Node):
    """自动发现机器人能力"""

    def __init__(self):
        super().__init__('rosclaw_discovery')

        # 创建服务
        self.get_capabilities = self.create_service(
            GetCapabilities, 
            '/rosclaw/get_capabilities',
            self.handle_get_capabilities
        )

        self.get_logger().info('RosClaw Discovery Node 已启动')

    def handle_get_capabilities(self, request, response):
        """返回机器人能力列表"""
        response.capabilities = [
            'navigation',
            'camera',
            'speak',
            'battery'
        ]
        return response

def main(args=None):
    rclpy.init(args=args)
    node = RosClawDiscovery()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
