import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class G(Node):
    def __init__(self):
        super().__init__('g'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def cb(self,p):
        m=Twist(); dist=math.hypot(8.0-p.x,3.0-p.y)
        if dist == 0:
            dist = 0.0001   # 防止除以 0
        a=math.atan2(3.0-p.y,8.0-p.x)-p.theta
        a=(a+math.pi)%(2*math.pi)-math.pi
        if dist>0.5:
            if abs(a)>0.1: m.angular.z=1.5*a
            else: m.linear.x=1.0; m.angular.z=a/dist
        self.pub.publish(m)
rclpy.init(); rclpy.spin(G())
