"""RosClaw 能力发现节点。把 TODO 补全。"""

import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class Discovery(Node):
    def __init__(self):
        super().__init__('rosclaw_discovery')
        # TODO: 创建服务 /rosclaw/get_capabilities，类型 GetCapabilities，回调函数 self.handle_get_capabilities
        self.get_logger().info('RosClaw Discovery Node 已启动')

    def handle_get_capabilities(self, request, response):
        """返回机器人的能力列表。"""
        # TODO: 给 response.capabilities 赋值：至少两种能力
        return response


def main():
    rclpy.init()
    node = Discovery()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
