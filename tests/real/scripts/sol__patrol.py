"""巡逻：依次走到四个点，每个点停一会儿。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

POINTS = [(2.0, 2.0), (9.0, 2.0), (9.0, 9.0), (2.0, 9.0)]  # m
TOLERANCE = 0.1  # m
WAIT = 1.2  # s


def fold(angle):
    """把角度折算到 -π 到 π。"""
    return math.atan2(math.sin(angle), math.cos(angle))


class Patrol(Node):
    def __init__(self):
        super().__init__('patrol')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.create_timer(0.02, self.control)
        self.pose = None
        self.index = 0  # 下一个目标
        self.arrived = None  # 到达的时刻

    def on_pose(self, pose):
        self.pose = pose

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def control(self):
        if self.pose is None:
            return
        x, y = POINTS[self.index]
        distance = math.hypot(x - self.pose.x, y - self.pose.y)
        msg = Twist()
        if self.arrived is None and distance < TOLERANCE:
            self.arrived = self.now()
        if self.arrived is not None:
            self.publisher.publish(msg)  # 停在这里等
            if self.now() - self.arrived >= WAIT:
                self.arrived = None
                self.index += 1
                if self.index == len(POINTS):
                    raise SystemExit
            return
        error = fold(math.atan2(y - self.pose.y, x - self.pose.x) - self.pose.theta)
        msg.angular.z = 4.0 * error
        msg.linear.x = min(2.0, 1.5 * distance) * max(math.cos(error), 0.0)
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Patrol()
    try:
        rclpy.spin(node)
    except SystemExit:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
