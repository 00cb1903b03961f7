import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.rate = self.create_rate(50)

    def drive(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        for i in range(int(t * 50)):
            self.rate.sleep()
            self.pub.publish(m)


def main():
    rclpy.init()
    node = Pentagon()
    for i in range(5):
        node.drive(1.0, 0.0, 2.0)
        node.drive(0.0, 1.2566, 1.0)
    node.drive(0.0, 0.0, 0.1)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
