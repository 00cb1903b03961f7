import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.step=0; self.begin=self.get_clock().now()
        self.create_timer(0.02,self.tick)
    def tick(self):
        m=Twist()
        if self.step >= 8:
            self.pub.publish(m)
            return
        elapsed=(self.get_clock().now()-self.begin).nanoseconds/1e9
        if self.step % 2 == 0:
            m.linear.x=1.0; duration=2.0
        else:
            m.angular.z=1.0; duration=1.0
        if elapsed >= duration:
            self.step += 1
            self.begin=self.get_clock().now()
        self.pub.publish(m)
rclpy.init(); rclpy.spin(Sq())
