import rclpy, time
from geometry_msgs.msg import Twist
def make_pub(n):
    p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
rclpy.init()
n = rclpy.create_node('s')
p = make_pub(n)
m = Twist()
m.linear.x = 1.0
for i in range(20):
    p.publish(m)
    time.sleep(0.1)
