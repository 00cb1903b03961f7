from __future__ import annotations
from dataclasses import dataclass, field
from typing import List
import time
import rclpy
from geometry_msgs.msg import Twist


@dataclass
class Segment:
    linear: float = 0.0
    angular: float = 0.0
    seconds: float = 1.0

    def twist(self) -> Twist:
        t = Twist()
        t.linear.x = self.linear
        t.angular.z = self.angular
        return t


@dataclass
class Plan:
    segments: List[Segment] = field(default_factory=list)

    def __iter__(self):
        return iter(self.segments)


plan = Plan([Segment(linear=1.0, seconds=0.6), Segment(angular=-1.0), Segment(1.0, 1.0, 0.9), Segment(seconds=0.0)])
rclpy.init()
node = rclpy.create_node('planner')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
for segment in plan:
    pub.publish(segment.twist())
    time.sleep(segment.seconds)
