import rclpy, math, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
    def turn(self, angle):
        if angle == 90:
            self.get_logger().info('直角转弯')
        self.send(0.0, 0.5, math.radians(angle)/0.5)
    def send(self,v,w,t):
        m=Twist(); m.linear.x=v; m.angular.z=w; t0=time.time()
        while time.time()-t0<t:
            self.pub.publish(m); time.sleep(0.01)
        self.pub.publish(Twist())
rclpy.init(); s=Sq(); time.sleep(0.5)
for i in range(3):
    s.send(1.0,0.0,2.0); s.turn(90)
rclpy.shutdown()
