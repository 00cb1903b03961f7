"""A class whose scripts all steer by `/turtle1/pose`: four ways to write it, right and wrong, for each motion.

Whoever listens handles 62.5 poses in a virtual second, where the lesson's scripts sleep.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from benchmarks.classroom import Script

_STEERING = '''
import math
import sys
import threading
import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

PLAN = {plan}


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.plan = list(PLAN)
        self.pose = None
        self.gone = self.turned = 0.0

    def on_pose(self, pose):
        if self.pose is not None:
            self.gone += math.dist((pose.x, pose.y), (self.pose.x, self.pose.y))
            self.turned += abs(math.remainder(pose.theta - self.pose.theta, math.tau))
        self.pose = pose

    def steer(self):
        """Publish the command for the present pose; False when the plan is done."""
        twist = Twist()
        if self.plan and self.pose is not None:
            kind, amount = self.plan[0]
            left = abs(amount) - (self.gone if kind == 'go' else self.turned)
            if left <= 0.005:
                self.plan.pop(0)
                self.gone = self.turned = 0.0
            speed = math.copysign(min(1.0, 0.05 + 2.0 * left), amount)
            if left > 0.005 and kind == 'go':
                twist.linear.x = speed
            elif left > 0.005:
                twist.angular.z = speed
        self.publisher.publish(twist)
        return bool(self.plan)


rclpy.init()
node = Driver()
'''
_STYLES = {
    "in_the_callback": """
class Steered(Driver):
    def on_pose(self, pose):
        super().on_pose(pose)
        self.steer()


node.destroy_node()
node = Steered()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
""",
    "in_a_loop": """
rclpy.spin_once(node)
while node.steer():
    rclpy.spin_once(node)
node.destroy_node()
rclpy.shutdown()
""",
    "in_a_timer": """
def tick():
    if not node.steer():
        sys.exit()


node.create_timer(0.05, tick)
rclpy.spin(node)
""",
    "beside_a_thread": """
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
time.sleep(0.5)
while node.steer():
    time.sleep(0.02)
rclpy.shutdown()
""",
}
_Plan = list[tuple[str, float]]


def _polygon(sides: int, side_m: float) -> _Plan:
    return [("go", side_m), ("turn", math.tau / sides)] * sides


PLANS: dict[str, _Plan] = {
    "straight": [("go", 2.0)],
    "backward": [("go", -2.0)],
    "spin": [("turn", math.tau + 0.05)],
    "square": _polygon(4, 2.0),
    "triangle": _polygon(3, 2.0),
    "pentagon": _polygon(5, 1.5),
}
"""What each motion takes: metres to go, radians to turn."""


def scripts() -> Iterator[Script]:
    """Yield every script, not graded yet: each style right, and one mistake in each."""
    for assignment, plan in PLANS.items():
        mistakes: tuple[_Plan, ...] = (
            plan[: max(1, len(plan) // 2)],
            [(kind, 0.7 * amount if kind == "turn" else amount) for kind, amount in plan],
            plan * 3,
            [("turn" if kind == "go" else "go", amount) for kind, amount in plan],
        )
        for (style, rest), wrong in zip(_STYLES.items(), mistakes, strict=True):
            for name, driven in (("right", plan), ("wrong", wrong)):
                source = _STEERING.format(plan=driven) + rest
                yield Script(assignment, f"{name}_{style}.py", source.encode(), right=name == "right")
