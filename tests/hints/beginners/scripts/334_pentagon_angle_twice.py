import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

JIAO = 1.257


class Wubian(Node):
    def __init__(self):
        super().__init__('wubian')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def fabu(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    w = Wubian()
    time.sleep(1)
    for _ in range(5):
        w.fabu(1.0, 0.0, 1.5)
        w.fabu(0.0, JIAO, JIAO)
    w.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
