import rclpy, time
from geometry_msgs.msg import Twist
from rclpy.node import Node

class NoStop(Node):
    def __init__(self):
        super().__init__('no_stop')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def seg(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)

def main():
    rclpy.init()
    n = NoStop()
    time.sleep(1)
    for i in range(4):
        n.seg(1.0, 0.0, 2.0)
        n.seg(0.0, 1.0, 1.5708)
    n.get_logger().info('完成')

if __name__ == '__main__':
    main()
