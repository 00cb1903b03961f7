import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Square(Node):
    """用位姿反馈走正方形"""

    def __init__(self):
        super().__init__('square_pose')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose

    def cmd(self, v, w):
        t = Twist()
        t.linear.x = v
        t.angular.z = w
        self.pub.publish(t)
        rclpy.spin_once(self)

    def run(self):
        while self.pose is None:
            rclpy.spin_once(self)
        for i in range(1, 5):
            x, y = self.pose.x, self.pose.y
            while math.hypot(self.pose.x - x, self.pose.y - y) < 2.0:
                self.cmd(1.0, 0.0)
            self.cmd(0.0, 0.0)
            goal = i * math.pi / 2
            while self.pose.theta < goal:
                self.cmd(0.0, 0.8)
            self.cmd(0.0, 0.0)


def main():
    rclpy.init()
    node = Square()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
