#!/usr/bin/env python3
"""RosClaw 节点  我的机器人会这些"""

import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class MyRobot(Node):
    nengli = ['移动', '旋转', 'draw_square']

    def __init__(self):
        super().__init__('my_robot')
        self.srv = self.create_service(GetCapabilities, '/rosclaw/get_capabilities', self.answer)
        self.get_logger().info('等待调用...')

    def answer(self, req, res):
        res.capabilities = list(self.nengli)
        self.get_logger().info('有人问我会什么')
        return res


def main(args=None):
    rclpy.init(args=args)
    node = MyRobot()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
