import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.state='side'; self.t=0.0; self.n=0; self.create_timer(0.02,self.tick)
    def tick(self):
        m=Twist(); self.t+=0.02
        if self.state == 'side':
            m.linear.x=1.0
            if self.t>=2.0: self.t=0.0; self.state='turn'
        elif self.state == 'turn':
            m.angular.z=math.pi/4
            if self.t>=2.0:
                self.t=0.0; self.n+=1; self.state='side' if self.n<3 else 'stop'
        elif self.state == 'sides':
            pass
        self.pub.publish(m)
rclpy.init(); rclpy.spin(Sq())
