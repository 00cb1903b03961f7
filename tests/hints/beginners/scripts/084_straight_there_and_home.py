import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Shuttle(Node):
    def __init__(self):
        super().__init__('shuttle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, t):
        m = Twist()
        m.linear.x = v
        n = int(t / 0.05)
        for i in range(n):
            self.pub.publish(m)
            time.sleep(0.05)

rclpy.init()
s = Shuttle()
time.sleep(1)
s.drive(1.0, 2.0)     # 前进
s.drive(-1.0, 2.0)    # 后退
s.drive(0.0, 0.2)
rclpy.shutdown()
