from collections import namedtuple
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

Step = namedtuple('Step', 'v w seconds')

SIDE, V, W = 3.0, 2.0, math.pi / 3
PLAN = [Step(0.0, 0.0, 1.0)]
for _ in range(4):
    PLAN += [
        Step(V, 0.0, SIDE / V),
        Step(0.0, 0.0, 0.2),
        Step(0.0, W, (math.pi / 2) / W),
        Step(0.0, 0.0, 0.2),
    ]


class Planner(Node):
    def __init__(self):
        super().__init__('planner')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.todo = list(PLAN)
        self.until = None
        self.create_timer(0.01, self.tick)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def tick(self):
        if self.until is None:
            self.until = self.now() + self.todo[0].seconds
        elif self.now() >= self.until:
            self.todo.pop(0)
            if not self.todo:
                self.pub.publish(Twist())
                raise SystemExit(0)
            self.until += self.todo[0].seconds
        msg = Twist()
        msg.linear.x = self.todo[0].v
        msg.angular.z = self.todo[0].w
        self.pub.publish(msg)


if __name__ == '__main__':
    rclpy.init()
    planner = Planner()
    try:
        rclpy.spin(planner)
    except (KeyboardInterrupt, SystemExit):
        pass
    rclpy.shutdown()
