import os
import sys
import time
import rclpy
from geometry_msgs.msg import Twist

GREEN = '\033[32m'
RESET = '\033[0m'


def banner():
    os.system('clear')
    print(GREEN + '海龟直行'.center(os.get_terminal_size().columns).strip() + RESET)


def main():
    banner()
    rclpy.init()
    node = rclpy.create_node('menu')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    cmd = Twist()
    cmd.linear.x = 0.8
    for i in range(10):
        pub.publish(cmd)
        sys.stdout.write('\r进度 %d/10' % (i + 1))
        sys.stdout.flush()
        time.sleep(0.25)
    cmd.linear.x = 0.0
    pub.publish(cmd)
    print()


main()
