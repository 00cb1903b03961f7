import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Sq(Node):
    def __init__(self):
        super().__init__('sq'); self.pub=self.create_publisher(Twist,'/turtle1/cmd_vel',10)
        self.t=0.0; self.side=0; self.log_count=0
        self.create_timer(0.02, self.tick)
    def tick(self):
        self.log_count += 1
        if self.log_count >= 10:
            self.get_logger().info('时间 %.1f' % self.t)
            self.log_count = 0
        m=Twist()
        self.t += 0.02
        if self.side < 4:
            if self.t <= 2.0:
                m.linear.x=1.0
            elif self.t <= 3.0:
                m.angular.z=1.0
            else:
                self.t=0.0; self.side+=1
        self.pub.publish(m)
rclpy.init(); rclpy.spin(Sq())
