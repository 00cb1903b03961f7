import rclpy, math, time
from geometry_msgs.msg import Twist
rclpy.init(); n=rclpy.create_node('s'); p=n.create_publisher(Twist,'/turtle1/cmd_vel',10); time.sleep(0.5)
def mv(v,w,t):
    m=Twist(); m.linear.x=float(v); m.angular.z=float(w); e=time.time()+t
    while time.time()<e:
        p.publish(m); time.sleep(0.01)
    p.publish(Twist())
def 边():
    mv(1,0,2); mv(0,1.5708,1)
[边() for _ in range(2)]
