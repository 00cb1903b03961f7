import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
theta = 0.0
class G(Node):
    def __init__(self):
        super().__init__('g'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def cb(self, msg):
        theta = msg.theta
        dx = 8.0 - msg.x
        dy = 3.0 - msg.y
        e = math.atan2(dx, dy) - theta
        e = math.atan2(math.sin(e), math.cos(e))
        m = Twist()
        if math.hypot(dx, dy) > 0.1:
            m.angular.z = 2.0 * e
            m.linear.x = 1.0 if abs(e) < 0.2 else 0.0
        self.p.publish(m)
rclpy.init(); rclpy.spin(G())
