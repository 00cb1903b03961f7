import rclpy, time, math
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Tri(Node):
    def __init__(self):
        super().__init__('tri')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    def act(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

rclpy.init()
tri = Tri()
time.sleep(1)
di = 3.0        # 底边
yao = 2.0       # 两条腰
for bian in (di, yao, yao):
    tri.act(1.0, 0.0, bian)
    tri.act(0.0, 1.0, math.pi * 2 / 3)
rclpy.shutdown()
