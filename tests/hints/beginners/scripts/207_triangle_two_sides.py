import time, rclpy
from geometry_msgs.msg import Twist

rclpy.init()
n = rclpy.create_node('sjx')
p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)

def f(a, b, s):
    m = Twist()
    m.linear.x = a
    m.angular.z = b
    t = time.time()
    while time.time() - t < s:
        p.publish(m)
        time.sleep(0.02)

for i in range(2):       # 0,1,2
    f(1.0, 0.0, 2.0)
    f(0.0, 1.0472, 2.0)
f(0.0, 0.0, 0.2)
