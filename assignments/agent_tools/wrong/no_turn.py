"""没有创建 /turn 服务。"""

import math
import time

import rclpy
from agent_tools_msgs.srv import Move, Turn, Where
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

SPEED = 0.5  # m/s
TURN_RATE = 0.5  # rad/s


class AgentTools(Node):
    def __init__(self):
        super().__init__('agent_tools')
        self.pose = Pose()
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.create_service(Move, '/move', self.move)
        self.create_service(Where, '/where', self.where)

    def on_pose(self, pose):
        self.pose = pose

    def drive(self, linear, angular, seconds):
        """按这个速度走 seconds 秒，然后停下。"""
        command = Twist()
        command.linear.x = linear
        command.angular.z = angular
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.publisher.publish(command)
            time.sleep(min(0.1, max(end - time.monotonic(), 0.0)))
        self.publisher.publish(Twist())

    def move(self, request, response):
        speed = math.copysign(SPEED, request.distance)
        self.drive(speed, 0.0, abs(request.distance) / SPEED)
        response.success = True
        response.message = f'已移动 {request.distance} 米'
        return response

    def turn(self, request, response):
        angle = math.radians(request.angle)
        self.drive(0.0, math.copysign(TURN_RATE, angle), abs(angle) / TURN_RATE)
        response.success = True
        response.message = f'已转 {request.angle} 度'
        return response

    def where(self, request, response):
        response.x = float(self.pose.x)
        response.y = float(self.pose.y)
        response.theta = float(self.pose.theta)
        return response


def main():
    rclpy.init()
    node = AgentTools()
    rclpy.spin(node)
    node.destroy_node()


if __name__ == '__main__':
    main()
