import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class P(Node):
    def __init__(self):
        super().__init__('p')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    def step(self, v, w):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)
        time.sleep(0.1)
    def square(self):
        j = 0
        k = 0
        for i in range(4):
            while j < 20:
                self.step(1.0, 0.0)
                j += 1
            while k < 20:
                self.step(0.0, 0.7854)
                k += 1
        self.pub.publish(Twist())
def main():
    rclpy.init()
    p = P()
    time.sleep(1)
    p.square()
if __name__ == '__main__':
    main()
