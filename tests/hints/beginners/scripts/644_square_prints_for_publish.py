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
        print(m)
        time.sleep(0.1)
    def square(self):
        for i in range(4):
            for j in range(20):
                self.step(1.0, 0.0)
            for j in range(20):
                self.step(0.0, 0.7854)
        self.pub.publish(Twist())
def main():
    rclpy.init()
    p = P()
    time.sleep(1)
    p.square()
if __name__ == '__main__':
    main()
