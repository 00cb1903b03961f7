import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
        self.state='走'; self.s=None; self.target=0.0; self.n=0
    def cb(self,p):
        m=Twist()
        if self.n>=4:
            self.pub.publish(m); return
        if self.state=='走':
            if self.s is None: self.s=(p.x,p.y)
            if math.dist(self.s,(p.x,p.y))<2.0: m.linear.x=1.0
            else: self.state='转'; self.target=p.theta+math.radians(80)
        else:
            err=math.atan2(math.sin(self.target-p.theta),math.cos(self.target-p.theta))
            if abs(err) > 0.3: m.angular.z=1.0
            elif abs(err) > 0.01: m.angular.z=0.3 if err>0 else -0.3
            else: self.state='走'; self.s=None; self.n+=1
        self.pub.publish(m)
rclpy.init(); rclpy.spin(Sq())
