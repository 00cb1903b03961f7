import rclpy, math, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.timer=self.create_timer(1.0,self.run)
    def run(self):
        self.timer.cancel()
        for i in range(4): self.mv(1.0,0.0,2.0); self.mv(0.0,1.0,math.pi/2)
    def mv(self,v,w,t):
        m=Twist(); m.linear.x=v; m.angular.z=w; e=time.time()+t
        while time.time()<e: self.p.publish(m); time.sleep(0.01)
        self.p.publish(Twist())
def main():
    rclpy.init()
    node=Sq()
    node.destroy_node()
    rclpy.shutdown()
main()
