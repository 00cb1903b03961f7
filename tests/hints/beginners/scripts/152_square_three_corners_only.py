import rclpy, time, math
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Z(Node):
    def __init__(self):
        super().__init__('z')
        self.p = self.create_publisher(Twist, 'turtle1/cmd_vel', 5)
        time.sleep(1.0)

    def do(self, v=0.0, w=0.0, t=0.1):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.monotonic() + t
        while time.monotonic() < e:
            self.p.publish(m)
            time.sleep(0.01)
        self.p.publish(Twist())
        time.sleep(0.1)

rclpy.init()
z = Z()
for i in range(4):
    z.do(v=1.0, t=2.0)
    if i < 3:                # 最后一个角不用转，已经回到起点了
        z.do(w=1.0, t=math.pi/2)
z.do()
rclpy.shutdown()
