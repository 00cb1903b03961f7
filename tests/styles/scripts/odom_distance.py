import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class OdomDriver(Node):
    def __init__(self):
        super().__init__('odom_driver')
        self.origin = None
        self.cmd_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.odom_sub = self.create_subscription(Odometry, '/odom', self.odom_callback, 10)

    def odom_callback(self, msg):
        p = msg.pose.pose.position
        if self.origin is None:
            self.origin = (p.x, p.y)
        d = math.hypot(p.x - self.origin[0], p.y - self.origin[1])
        cmd = Twist()
        if d < 1.5:
            cmd.linear.x = 0.5
            self.cmd_pub.publish(cmd)
        else:
            self.cmd_pub.publish(cmd)
            self.get_logger().info('distance %.2f m' % d)
            rclpy.shutdown()


rclpy.init()
rclpy.spin(OdomDriver())
