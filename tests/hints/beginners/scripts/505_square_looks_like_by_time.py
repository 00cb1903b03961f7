import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class P(Node):
    def __init__(self):
        super().__init__('p'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.create_subscription(Pose,'/turtle1/pose',self.cb,10); self.q=None
        self.k=0; self.s=None; self.st='go'; self.h=0.0; self.lengths=[2.0,2.0,1.5,2.0]; self.create_timer(0.02,self.tick)
    def cb(self,q): self.q=q
    def tick(self):
        q=self.q
        if q is None: return
        m=Twist()
        if self.k<4:
            if self.st=='go':
                if self.s is None: self.s=(q.x,q.y)
                if math.dist(self.s,(q.x,q.y))<self.lengths[self.k]: m.linear.x=1.0
                else: self.st='turn'; self.h+=math.pi/2
            else:
                e=math.remainder(self.h-q.theta,math.tau); m.angular.z=2*e
                if abs(e)<0.02: self.st='go'; self.k+=1; self.s=None; m.angular.z=0.0
        self.p.publish(m)
rclpy.init(); rclpy.spin(P())
