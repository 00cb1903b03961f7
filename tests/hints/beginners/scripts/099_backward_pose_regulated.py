import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Reverse(Node):
    """退到 x 比起点小 1.5 米的地方，越近越慢"""

    def __init__(self):
        super().__init__('reverse')
        self.goal = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def on_pose(self, pose):
        if self.goal is None:
            self.goal = pose.x - 1.5
            return
        rest = pose.x - self.goal
        msg = Twist()
        if rest > 0.02:
            msg.linear.x = -min(1.0, 2.0 * rest)
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Reverse())


if __name__ == '__main__':
    main()
