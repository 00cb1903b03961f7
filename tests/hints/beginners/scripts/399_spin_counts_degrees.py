import rclpy, time
from geometry_msgs.msg import Twist
rclpy.init()
n = rclpy.create_node('x')
p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
m = Twist()
m.angular.z = 1.0
jiao = 0
while jiao < 360:
    p.publish(m)
    time.sleep(0.1)
    jiao += 1.0 * 0.1
p.publish(Twist())
