import sys
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    # 用法: python3 square_input.py 2.0
    side = float(sys.argv[1])
    rclpy.init()
    node = Node('sq_argv')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    for i in range(8):
        m = Twist()
        if i % 2 == 0:
            m.linear.x = 1.0
            t = side
        else:
            m.angular.z = 1.5708
            t = 1.0
        e = time.time() + t
        while time.time() < e:
            pub.publish(m)
            time.sleep(0.01)
        pub.publish(Twist())
        time.sleep(0.1)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
