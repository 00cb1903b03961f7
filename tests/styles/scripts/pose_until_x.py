import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Go(Node):
    def __init__(self):
        super().__init__('go')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.pose_cb, 10)
        self.arrived = False

    def pose_cb(self, pose):
        msg = Twist()
        if pose.x < 8.0 and not self.arrived:
            msg.linear.x = 1.0
        elif not self.arrived:
            self.arrived = True
            self.get_logger().info(f'到达 x={pose.x:.1f}')
        self.pub.publish(msg)


rclpy.init()
try:
    rclpy.spin(Go())
except KeyboardInterrupt:
    pass
