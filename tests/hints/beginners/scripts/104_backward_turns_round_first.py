import time, math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class UTurn(Node):
    def __init__(self):
        super().__init__('u_turn')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def cmd(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        t0 = time.time()
        while time.time() - t0 < t:
            self.pub.publish(m)
            time.sleep(0.01)


rclpy.init()
node = UTurn()
time.sleep(1)
node.cmd(0.0, math.pi / 2, 2.0)   # 掉头
node.cmd(1.0, 0.0, 2.0)           # 往后走
node.cmd(0.0, 0.0, 0.1)
node.destroy_node()
rclpy.shutdown()
