import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class S(Node):
    def __init__(self):
        super().__init__('s'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.k=0; self.t=self.create_timer(0.1,self.cb)
    def cb(self):
        m=Twist()
        if self.k<10: m.linear.x=0.5
        else: self.t.cancel()
        self.k+=1; self.p.publish(m)
rclpy.init(); rclpy.spin(S())
