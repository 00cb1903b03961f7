import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class ByPose(Node):
    """不用时间，用位置判断走了多远"""

    def __init__(self):
        super().__init__('by_pose')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.pose_cb, 10)
        self.start = None
        self.done = False

    def pose_cb(self, p):
        if self.start is None:
            self.start = (p.x, p.y)
        gone = math.hypot(p.x - self.start[0], p.y - self.start[1])
        cmd = Twist()
        if gone < 1.0 and not self.done:
            cmd.linear.x = 0.5
        else:
            self.done = True
        self.pub.publish(cmd)


def main():
    rclpy.init()
    node = ByPose()
    while rclpy.ok() and not node.done:
        rclpy.spin_once(node)
    node.get_logger().info('走完 1 米')
    rclpy.spin_once(node, timeout_sec=0.3)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
