import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import TeleportAbsolute, SetPen
from std_srvs.srv import Empty
class G(Node):
    def __init__(self):
        super().__init__('g'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.call(TeleportAbsolute,'/turtle1/teleport_absolute',TeleportAbsolute.Request(x=1.0,y=1.0))
        self.goals=[(8.0,3.0)]; self.until=None
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def call(self,t,name,r):
        c=self.create_client(t,name); c.wait_for_service(); f=c.call_async(r); rclpy.spin_until_future_complete(self,f)
    def cb(self,q):
        m=Twist(); now=self.get_clock().now().nanoseconds/1e9
        if self.until is not None:
            if now>=self.until: self.until=None; self.goals.pop(0)
        elif self.goals:
            x,y=self.goals[0]; d=math.hypot(x-q.x,y-q.y); e=math.remainder(math.atan2(y-q.y,x-q.x)-q.theta,math.tau)
            if d<0.08: self.until=now+1.2
            else: m.angular.z=3*e; m.linear.x=min(2.0,2*d)*max(0.0,math.cos(e))
        self.p.publish(m)
rclpy.init(); rclpy.spin(G())
