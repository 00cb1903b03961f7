"""停车：在 control() 里补全。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

GATE = (7.6, 4.5)  # 车位正前方
SPOT = (7.6, 1.8)  # 车位中心
HEADING = -math.pi / 2  # 停车时的朝向
MAX_SPEED = 1.2  # m/s
STEP = 0.02  # 每一步速度最多变化这么多，m/s


def fold(angle):
    """把角度折算到 -π 到 π。"""
    return math.atan2(math.sin(angle), math.cos(angle))


class Parking(Node):
    def __init__(self):
        super().__init__('parking')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.create_timer(0.02, self.control)
        self.pose = None
        self.targets = [GATE, SPOT]
        self.speed = 0.0

    def on_pose(self, pose):
        self.pose = pose

    def send(self, v, w):
        self.speed += min(max(v - self.speed, -STEP), STEP)  # 慢慢加速、减速
        msg = Twist()
        msg.linear.x = self.speed
        msg.angular.z = w
        self.publisher.publish(msg)

    def control(self):
        if self.pose is None:
            return
        # TODO：先到车位前方的 GATE，再开进车位中心 SPOT，最后转到 HEADING 停下


def main():
    rclpy.init()
    node = Parking()
    try:
        rclpy.spin(node)
    except SystemExit:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
