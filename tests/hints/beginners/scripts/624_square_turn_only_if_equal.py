import math

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class PoseSquare(Node):
    def __init__(self):
        super().__init__('pose_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.timer = self.create_timer(0.02, self.control)
        self.pose = None
        self.state = 'start'
        self.corner = 0

    def on_pose(self, msg):
        self.pose = msg

    def control(self):
        if self.pose is None:
            return
        cmd = Twist()
        if self.state == 'start':
            self.x0 = self.pose.x
            self.y0 = self.pose.y
            self.state = 'go'
        elif self.state == 'go':
            d = math.sqrt((self.pose.x - self.x0) ** 2 + (self.pose.y - self.y0) ** 2)
            if d < 2.0:
                cmd.linear.x = 1.0
            else:
                self.goal = self.pose.theta + math.pi / 2
                if self.goal > math.pi:
                    self.goal -= 2 * math.pi
                self.state = 'turn'
        elif self.state == 'turn':
            diff = self.goal - self.pose.theta
            diff = math.atan2(math.sin(diff), math.cos(diff))
            if diff == 0:
                cmd.angular.z = max(0.1, min(1.0, 2.0 * diff))
            else:
                self.corner += 1
                self.state = 'start' if self.corner < 4 else 'done'
        self.pub.publish(cmd)


def main():
    rclpy.init()
    node = PoseSquare()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
