import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class T(Node):
    def __init__(self):
        super().__init__('t')
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
t = T()
time.sleep(1)
for i in range(3):
    t.act(1.0, 0.0, 1.5)
    if i == 2:
        t.act(0.0, 1.0, 2.094)
t.destroy_node()
rclpy.shutdown()
