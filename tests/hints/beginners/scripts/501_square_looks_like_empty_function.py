import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Base(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
    def run(self):
        pass
    def go(self,t):
        m=Twist(); m.linear.x=1.0; e=time.time()+t
        while time.time()<e:
            self.pub.publish(m); time.sleep(0.02)
        self.pub.publish(Twist())
class Sq(Base):
    def run(self):
        for i in range(4):
            self.go(1.0)
rclpy.init(); s=Sq(); time.sleep(0.5); s.run()
