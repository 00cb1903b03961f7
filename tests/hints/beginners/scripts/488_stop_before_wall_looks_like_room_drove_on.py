from rclpy.qos import qos_profile_sensor_data
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
class S(Node):
    def __init__(self):
        super().__init__('s'); self.p=self.create_publisher(Twist,'/cmd_vel',10); self.create_subscription(LaserScan,'scan',self.cb,qos_profile_sensor_data)
    def cb(self,msg):
        if msg.ranges[0]>0.5:
            m=Twist(); m.linear.x=0.15; self.p.publish(m)
        else:
            self.get_logger().info('太近了')
rclpy.init(); rclpy.spin(S())
