"""停车：先到车位前方，再开进去，车头朝里。"""

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
        if not self.targets:
            self.finish()
            return
        x, y = self.targets[0]
        distance = math.hypot(x - self.pose.x, y - self.pose.y)
        if distance < 0.05:
            self.targets.pop(0)
            return
        error = fold(math.atan2(y - self.pose.y, x - self.pose.x) - self.pose.theta)
        straight = max(math.cos(error), 0.0) ** 8  # 先转向目标
        self.send(min(MAX_SPEED, 0.6 * distance + 0.02) * straight, 3.0 * error if distance > 0.1 else 0.0)

    def finish(self):
        """转到要求的朝向，然后停下。"""
        error = fold(HEADING - self.pose.theta)
        self.send(0.0, 3.0 * error)
        if abs(error) < 0.01 and self.speed == 0.0:
            raise SystemExit


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
