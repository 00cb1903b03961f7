import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('zhengfangxing')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)

    a = Twist()
    a.linear.x = 1.0
    b = Twist()
    b.angular.z = 1.0

    for i in range(4):
        # 直行2秒
        for j in range(40):
            pub.publish(a)
            time.sleep(0.05)
        # 转弯1.5秒
        for j in range(30):
            pub.publish(b)
            time.sleep(0.05)
    pub.publish(Twist())
    time.sleep(0.5)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
