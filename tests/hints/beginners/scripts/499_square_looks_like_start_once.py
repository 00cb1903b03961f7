import rclpy, math, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.begin = time.time()
    def move(self, d):
        m=Twist(); m.linear.x=1.0; t0=time.time()
        while time.time()-t0 < d and time.time()-self.begin < 60:
            self.pub.publish(m); time.sleep(0.01)
        self.pub.publish(Twist())
    def turn(self, t):
        m=Twist(); m.angular.z=math.pi/4; t0=time.time()
        while time.time()-t0 < t and time.time()-self.begin < 60:
            self.pub.publish(m); time.sleep(0.01)
        self.pub.publish(Twist())
rclpy.init(); s=Sq(); time.sleep(0.5)
for i in range(3):
    s.move(2.0); s.turn(2.0)
