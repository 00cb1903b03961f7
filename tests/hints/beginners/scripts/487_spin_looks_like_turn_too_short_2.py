import rclpy, time
from rclpy.node import Node
from rclpy.action import ActionClient
from geometry_msgs.msg import Twist
from turtlesim.action import RotateAbsolute
class S(Node):
    def __init__(self):
        super().__init__('s'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.a=ActionClient(self,RotateAbsolute,'/turtle1/rotate_absolute')
        self.create_timer(0.1,lambda: self.p.publish(Twist()))
    def turn(self,th):
        self.a.wait_for_server(); f=self.a.send_goal_async(RotateAbsolute.Goal(theta=th)); rclpy.spin_until_future_complete(self,f); r=f.result().get_result_async(); rclpy.spin_until_future_complete(self,r)
rclpy.init(); s=S()
for th in (1.57,3.14,-1.57,0.0): s.turn(th)
rclpy.spin(s)
