import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Blind(Node):
    def __init__(self):
        super().__init__('blind')
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def on_pose(self, pose):
        self.pose = pose


rclpy.init()
node = Blind()
msg = Twist()
msg.angular.z = 1.0
node.pub.publish(msg)
while node.pose is None:
    pass
print('never')
