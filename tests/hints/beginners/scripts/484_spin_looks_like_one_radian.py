import rclpy, time, math
from geometry_msgs.msg import Twist
rclpy.init(); node=rclpy.create_node('s'); pub=node.create_publisher(Twist,'/turtle1/cmd_vel',10); time.sleep(1)
m=Twist(); m.angular.z=math.radians(60)
for i in range(10):
    pub.publish(m); time.sleep(0.1)
pub.publish(Twist())
