import rclpy
import time
import math
from rclpy.node import Node
from geometry_msgs.msg import Twist

# 五角星！
class Star(Node):
    def __init__(self):
        super().__init__('star')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def draw(self):
        for i in range(5):
            self.go(1.0, 0.0, 2.0)
            self.go(0.0, 1.0, math.pi * 4 / 5)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        a = time.time()
        while time.time() - a < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

if __name__ == '__main__':
    rclpy.init()
    star = Star()
    time.sleep(1)
    star.draw()
    star.destroy_node()
    rclpy.shutdown()
