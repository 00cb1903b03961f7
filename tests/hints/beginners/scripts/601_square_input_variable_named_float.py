import rclpy, time, math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        float = 2.0
        self.side = float(input('边长:'))
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        time.sleep(1)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        t0 = time.time()
        while time.time() - t0 < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for i in range(4):
            self.go(1.0, 0.0, self.side)
            self.go(0.0, 1.0, math.pi / 2)


def main(args=None):
    rclpy.init(args=args)
    n = Square()
    n.run()
    rclpy.shutdown()


main()
