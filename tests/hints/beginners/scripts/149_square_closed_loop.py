import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


def norm(a):
    while a > math.pi:
        a -= 2 * math.pi
    while a < -math.pi:
        a += 2 * math.pi
    return a


class ClosedLoop(Node):
    def __init__(self):
        super().__init__('closed_loop')
        self.pose = None
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.save, 10)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def save(self, pose):
        self.pose = pose

    def cmd(self, v, w):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)
        rclpy.spin_once(self)

    def go(self, length):
        x, y = self.pose.x, self.pose.y
        while True:
            rest = length - math.hypot(self.pose.x - x, self.pose.y - y)
            if rest < 0.005:
                break
            self.cmd(min(1.5, 2 * rest + 0.05), 0.0)
        self.cmd(0.0, 0.0)

    def face(self, theta):
        while True:
            err = norm(theta - self.pose.theta)
            if abs(err) < 0.003:
                break
            self.cmd(0.0, max(-1.5, min(1.5, 2 * err)))
        self.cmd(0.0, 0.0)


def main():
    rclpy.init()
    node = ClosedLoop()
    while node.pose is None:
        rclpy.spin_once(node)
    theta = node.pose.theta
    for i in range(4):
        node.go(2.0)
        theta += math.pi / 2
        node.face(theta)
        node.get_logger().info('第%d个角' % (i + 1))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
