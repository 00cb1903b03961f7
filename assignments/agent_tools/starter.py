"""给聊天智能体的工具：/move、/turn、/where。"""

import rclpy
from agent_tools_msgs.srv import Move, Turn, Where
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class AgentTools(Node):
    def __init__(self):
        super().__init__('agent_tools')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        # TODO: 订阅 /turtle1/pose（Pose），记住最新的位置
        self.create_service(Move, '/move', self.move)
        # TODO: 再创建 /turn（Turn）和 /where（Where）

    def move(self, request, response):
        # TODO: 前进 request.distance 米（负数后退），走完停下，再回应
        response.success = False
        return response


def main():
    rclpy.init()
    node = AgentTools()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
