import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
PI = 3.14159265
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
        self.state=0; self.sx=None; self.target=0.0; self.n=0
    def cb(self,p):
        m=Twist(); heading=p.theta*180.0/PI
        if self.n>=4:
            self.pub.publish(m); return
        if self.state==0:
            if self.sx is None: self.sx=(p.x,p.y)
            if ((p.x-self.sx[0])**2+(p.y-self.sx[1])**2)**0.5<2.0: m.linear.x=1.0
            else:
                self.state=1; self.target=heading+90
        else:
            if heading<self.target: m.angular.z=0.5
            else:
                self.state=0; self.sx=None; self.n+=1
        self.pub.publish(m)
rclpy.init(); rclpy.spin(Sq())
