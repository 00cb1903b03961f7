import rclpy, math, time
from geometry_msgs.msg import Twist
rclpy.init(); n=rclpy.create_node('s'); p=n.create_publisher(Twist,'/turtle1/cmd_vel',10); time.sleep(0.5)
side_time = 2.0 / 0.7
n_side = int(side_time / 0.1)
w=math.radians(80)/2.0
for i in range(4):
    for _ in range(n_side):
        m=Twist(); m.linear.x=0.7; p.publish(m); time.sleep(0.1)
    for _ in range(20):
        m=Twist(); m.angular.z=w; p.publish(m); time.sleep(0.1)
p.publish(Twist())
