import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class G(Node):
    def __init__(self):
        super().__init__('g'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10); self.m=Twist()
        self.create_timer(0.02,self.send)
    def send(self):
        self.pub.publish(self.m)
    def cb(self,p):
        dx=8.0-p.x; dy=3.0-p.y
        dist=math.hypot(dx,dy)
        angle_error=math.atan2(dy,dx)-p.theta
        angle_error=math.atan2(math.sin(angle_error),math.cos(angle_error))
        if dist < 0.1:
            self.get_logger().info('到了')
            return
        if angle_error > 0.01 or angle_error < -0.01:
            self.m.angular.z=2.0*angle_error
        else:
            self.m.angular.z=0.0
        self.m.linear.x=1.0 if abs(angle_error)<0.2 else 0.0
rclpy.init(); rclpy.spin(G())
