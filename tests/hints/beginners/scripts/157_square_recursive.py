import rclpy
import time
from geometry_msgs.msg import Twist
from rclpy.node import Node

PI = 3.14159


def side(node, pub, left):
    """画一条边，然后自己调用自己"""
    if left == 0:
        return
    fabu(pub, 1.0, 0.0, 1.8)
    fabu(pub, 0.0, 1.0, PI / 2)
    node.get_logger().info('还剩 %d 条' % (left - 1))
    side(node, pub, left - 1)


def fabu(pub, x, z, t):
    m = Twist()
    m.linear.x = x
    m.angular.z = z
    t0 = time.time()
    while time.time() - t0 < t:
        pub.publish(m)
        time.sleep(0.005)
    m.linear.x = 0.0
    m.angular.z = 0.0
    pub.publish(m)
    time.sleep(0.1)


if __name__ == '__main__':
    rclpy.init()
    n = Node('digui')
    p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    side(n, p, 4)
    n.destroy_node()
    rclpy.shutdown()
