import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class R(Node):
    def __init__(self):
        super().__init__('r')
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
r = R()
time.sleep(1)
for i in range(2):      # 两条长
    r.go(1.0, 0.0, 3.0)
    r.go(0.0, 1.0, 1.5708)
for i in range(2):      # 两条宽
    r.go(1.0, 0.0, 2.0)
    r.go(0.0, 1.0, 1.5708)
rclpy.shutdown()
