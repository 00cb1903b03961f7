import rclpy, math, threading, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class G(Node):
    def __init__(self):
        super().__init__('g'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.pose=None
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def cb(self,m): self.pose=m
    def go(self):
        d=math.hypot(8-self.pose.x,3-self.pose.y)
rclpy.init(); g=G(); threading.Thread(target=rclpy.spin,args=(g,),daemon=True).start(); g.go()
