import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class GoToGoal(Node):
    """P controller along x, the way every tutorial does it."""

    def __init__(self, goal_x):
        super().__init__('go_to_goal')
        self.goal_x = goal_x
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.update_pose, 10)
        self.create_timer(0.1, self.control_loop)
        self.done = rclpy.task.Future()

    def update_pose(self, data):
        self.pose = data

    def control_loop(self):
        if self.pose is None:
            return
        distance = math.sqrt((self.goal_x - self.pose.x) ** 2)
        twist = Twist()
        if distance > 0.05:
            twist.linear.x = 1.0 * distance
        self.pub.publish(twist)
        if distance <= 0.05:
            self.done.set_result(True)


def main():
    rclpy.init()
    node = GoToGoal(8.5)
    rclpy.spin_until_future_complete(node, node.done)
    print('reached', node.done.result())
    rclpy.shutdown()


main()
