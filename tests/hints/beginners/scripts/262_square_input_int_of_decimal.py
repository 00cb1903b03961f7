import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

bianchang = int(input('输入边长：'))

class F(Node):
    def __init__(self):
        super().__init__('f')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

rclpy.init()
f = F()
time.sleep(1)
for i in range(4):
    f.go(1.0, 0.0, bianchang)
    f.go(0.0, 1.0, 1.5708)
rclpy.shutdown()
