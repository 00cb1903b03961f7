import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class G(Node):
    def __init__(self):
        super().__init__('g'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10); self.pose_theta0=None
    def cb(self,q):
        d=math.hypot(8-q.x,3-q.y); m=Twist()
        angle=math.remainder(math.atan2(3-q.y,8-q.x)-q.theta,math.tau)
        arrived_dist = d < 0.4
        if arrived_dist == 1:
            self.p.publish(m); return
        m.angular.z=3*angle
        if abs(angle)<0.1: m.linear.x=1.0
        self.p.publish(m)
rclpy.init(); rclpy.spin(G())
