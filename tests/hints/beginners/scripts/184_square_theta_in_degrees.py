import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class PoseSquare(Node):
    def __init__(self):
        super().__init__('pose_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.x = self.y = self.theta = None

    def cb(self, p):
        self.x, self.y, self.theta = p.x, p.y, p.theta

    def drive(self, v, w):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)
        rclpy.spin_once(self)

    def run(self):
        while self.x is None:
            rclpy.spin_once(self)
        target = 0
        for i in range(4):
            x0, y0 = self.x, self.y
            while abs(self.x - x0) + abs(self.y - y0) < 2.0:
                self.drive(1.0, 0.0)
            target += 90
            while self.theta < target:
                self.drive(0.0, 0.5)
        self.drive(0.0, 0.0)


rclpy.init()
node = PoseSquare()
node.run()
rclpy.shutdown()
