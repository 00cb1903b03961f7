import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Spiral(Node):
    def __init__(self):
        super().__init__('fang_spiral')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, s):
        m = Twist(); m.linear.x = v; m.angular.z = w
        e = time.time() + s
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

rclpy.init()
n = Spiral()
time.sleep(1)
for i in range(1, 5):
    n.go(1.0, 0.0, 0.5 * i)
    n.go(0.0, 1.0, 1.5708)
rclpy.shutdown()
