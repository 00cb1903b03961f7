import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class G(Node):
    def __init__(self):
        super().__init__('g'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.x = 8.0   # 目标点
        self.y = 3.0
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def cb(self, msg):
        x = msg.x
        y = msg.y
        theta = msg.theta
        dx = self.x - x
        dy = self.y - y
        e = math.atan2(dx, dy) - theta
        e = math.atan2(math.sin(e), math.cos(e))
        m = Twist()
        if math.hypot(dx, dy) > 0.1:
            m.angular.z = 2.0 * e
            m.linear.x = 1.0 if abs(e) < 0.2 else 0.0
        self.p.publish(m)
rclpy.init(); rclpy.spin(G())
