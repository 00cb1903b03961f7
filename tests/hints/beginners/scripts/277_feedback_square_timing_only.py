import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Fb(Node):
    def __init__(self):
        super().__init__('fb')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)

    def cb(self, pose):
        self.get_logger().info(f'x={pose.x:.2f} y={pose.y:.2f}')

    def act(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            rclpy.spin_once(self, timeout_sec=0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    fb = Fb()
    time.sleep(1)
    for i in range(4):
        fb.act(1.0, 0.0, 2.0)
        fb.act(0.0, 1.0, 1.5708)
    fb.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
