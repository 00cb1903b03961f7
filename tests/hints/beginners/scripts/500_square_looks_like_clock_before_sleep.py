import rclpy, time
from geometry_msgs.msg import Twist
rclpy.init(); node=rclpy.create_node('sq'); pub=node.create_publisher(Twist,'/turtle1/cmd_vel',10)
t_all = time.time()
time.sleep(1.0)
side = 0
while time.time() - t_all < 60 and side < 4:
    m=Twist(); m.linear.x=1.0
    for _ in range(20): pub.publish(m); time.sleep(0.1)
    m=Twist(); m.angular.z=1.0
    for _ in range(10): pub.publish(m); time.sleep(0.1)
    side += 1
pub.publish(Twist())
