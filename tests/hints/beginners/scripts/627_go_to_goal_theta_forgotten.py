import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.goal_x = 8.0
        self.goal_y = 3.0
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.pose_cb, 10)
        self.create_timer(0.05, self.control)

    def pose_cb(self, msg):
        self.pose = msg

    def control(self):
        if self.pose is None:
            return
        dx = self.goal_x - self.pose.x
        dy = self.goal_y - self.pose.y
        distance = math.hypot(dx, dy)
        cmd = Twist()
        if distance > 0.1:
            target = math.atan2(dy, dx)
            err = target
            if abs(err) > 0.1:
                cmd.angular.z = 2.0 * err
            else:
                cmd.linear.x = min(1.5, 1.0 * distance + 0.2)
                cmd.angular.z = 2.0 * err
        self.pub.publish(cmd)


def main():
    rclpy.init()
    node = GoToGoal()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
