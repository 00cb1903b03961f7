import rclpy, time
from geometry_msgs.msg import Twist
rclpy.init(); node=rclpy.create_node('s'); pub=node.create_publisher(Twist,'/turtle1/cmd_vel',10); time.sleep(1)
times = 0
while times < 2:
    m=Twist(); m.linear.x=2.0
    pub.publish(m); time.sleep(1)
    m=Twist(); m.angular.z=1.5708
    pub.publish(m); time.sleep(1)
    times += 1
pub.publish(Twist())
