import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

SIDES = 6
ANGLE = 1.047

class Poly(Node):
    def __init__(self):
        super().__init__('poly')
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

def main():
    rclpy.init()
    p = Poly()
    time.sleep(1)
    for _ in range(SIDES):
        p.go(1.0, 0.0, 1.5)
        p.go(0.0, 1.0, ANGLE)
    rclpy.shutdown()

main()
