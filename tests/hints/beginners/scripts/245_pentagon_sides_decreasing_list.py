import rclpy
import time
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.bian = [1, 2, 3, 4, 5]

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def draw(self):
        for b in self.bian:
            self.get_logger().info(f'边 {b}')
            self.go(1.0, 0.0, 2.0)
            self.go(0.0, 1.0, 1.2566)
            self.bian.remove(b)      # 走完一条删一条


rclpy.init()
node = Pentagon()
time.sleep(1)
node.draw()
rclpy.shutdown()
