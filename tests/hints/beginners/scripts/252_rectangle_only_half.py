import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


def fa(pub, v, w, t):
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    e = time.time() + t
    while time.time() < e:
        pub.publish(m)
        time.sleep(0.01)
    pub.publish(Twist())
    time.sleep(0.1)


def main():
    rclpy.init()
    node = Node('changfangxing')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    fa(pub, 1.0, 0.0, 3.0)
    fa(pub, 0.0, 1.0, 1.5708)
    fa(pub, 1.0, 0.0, 2.0)
    fa(pub, 0.0, 1.0, 1.5708)
    node.get_logger().info('长方形完成')
    rclpy.shutdown()


main()
