import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class NoArgument(Node):
    def __init__(self):
        super().__init__('no_argument')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.01, self.tick)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def tick(self):
        msg = Twist()
        msg.angular.z = 1.0
        self.pub.publish(msg)

    def on_pose(self):
        pass


rclpy.init()
rclpy.spin(NoArgument())
