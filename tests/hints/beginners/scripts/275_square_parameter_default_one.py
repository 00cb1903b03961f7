import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class D(Node):
    def __init__(self):
        super().__init__('d')
        self.declare_parameter('side', 1.0)
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
d = D()
time.sleep(1)
L = d.get_parameter('side').value
for k in range(4):
    d.go(1.0, 0.0, L)
    d.go(0.0, 1.0, 1.5708)
rclpy.shutdown()
