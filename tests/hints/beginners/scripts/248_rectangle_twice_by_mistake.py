import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Rect(Node):
    def __init__(self):
        super().__init__('rect')
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
r = Rect()
time.sleep(1)
for i in range(4):
    r.go(1.0, 0.0, 2.0)
    r.go(0.0, -1.5708, 1.0)
    r.go(1.0, 0.0, 3.0)
    r.go(0.0, -1.5708, 1.0)
    if i == 1:
        print('其实已经走了一圈了')
    if i == 3:
        print('两圈')
r.destroy_node()
rclpy.shutdown()
