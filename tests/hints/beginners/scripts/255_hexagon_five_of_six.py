import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class H(Node):
    def __init__(self):
        super().__init__('h6')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    def a(self, v, w, t):
        m = Twist(); m.linear.x = v; m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m); time.sleep(0.01)
        self.pub.publish(Twist()); time.sleep(0.1)

rclpy.init(); h = H(); time.sleep(1)
for bian in range(1, 6):
    h.a(1.0, 0.0, 1.5)
    h.a(0.0, 1.0, 1.047)
rclpy.shutdown()
