import rclpy, math, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self, side):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.side=side; self.phase=0; self.done=0; self.k=0
        self.timer=self.create_timer(0.02,self.tick)
    def tick(self):
        m=Twist()
        if self.done<8:
            if self.phase==0:
                m.linear.x=1.0; need=self.side*1.5/1.0
            else:
                m.angular.z=math.pi/4; need=2.0
            self.k+=1
            if self.k*0.02>=need:
                self.k=0; self.phase+=1; self.done+=1
                if self.phase > 1:
                    self.phase = 0
        self.pub.publish(m)
s=float(input('请输入边长: '))
rclpy.init(); rclpy.spin(Sq(s))
