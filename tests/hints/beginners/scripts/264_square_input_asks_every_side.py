import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Sq(Node):
    def __init__(self):
        super().__init__('sq')
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
    sq = Sq()
    time.sleep(1)
    for i in range(4):
        side = float(input(f'第{i + 1}条边的边长: '))
        sq.go(1.0, 0.0, side)
        sq.go(0.0, 1.0, 1.5708)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
