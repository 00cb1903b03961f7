import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class GoalTriangle(Node):
    """先算好三个顶点，再一个一个开过去"""

    def __init__(self):
        super().__init__('goal_triangle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.goals = None
        self.turning = False

    def on_pose(self, p):
        if self.goals is None:
            a = 2.5
            self.goals = [
                (p.x + a, p.y),
                (p.x + a / 2, p.y + a * math.sqrt(3) / 2),
                (p.x, p.y),
            ]
            self.turning = True
        msg = Twist()
        if self.goals:
            gx, gy = self.goals[0]
            rest = math.hypot(gx - p.x, gy - p.y)
            err = math.atan2(gy - p.y, gx - p.x) - p.theta
            err = math.atan2(math.sin(err), math.cos(err))
            if rest < 0.03:
                self.goals.pop(0)
                self.turning = True
            elif self.turning:
                if abs(err) < 0.01:
                    self.turning = False
                msg.angular.z = 2.0 * err
            else:
                msg.linear.x = min(1.0, 2 * rest)
                if rest > 0.3:
                    msg.angular.z = 2.0 * err
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = GoalTriangle()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
