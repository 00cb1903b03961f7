import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class P(Node):
    def __init__(self):
        super().__init__('p'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.create_subscription(Pose,'/turtle1/pose',self.cb,10); self.th=None; self.create_timer(0.01,self.tick)
    def cb(self,q): self.th=q.theta
    def tick(self):
        m=Twist(); m.linear.x=math.cos(self.th); self.p.publish(m)
rclpy.init(); rclpy.spin(P())
