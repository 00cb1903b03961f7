import argparse
import sys
import time
import rclpy
from geometry_msgs.msg import Twist


def main(argv=None):
    parser = argparse.ArgumentParser(description='drive')
    parser.add_argument('--speed', type=float, default=1.0)
    parser.add_argument('-n', '--sides', type=int, default=4)
    known, rest = parser.parse_known_args(argv)
    rclpy.init(args=rest)
    node = rclpy.create_node('argparse_node')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    print(node.get_name(), sys.argv[0])
    for _ in range(known.sides):
        for v, w in ((known.speed, 0.0), (0.0, 6.283185 / known.sides)):
            msg = Twist()
            msg.linear.x, msg.angular.z = v, w
            for _ in range(10):
                pub.publish(msg)
                time.sleep(0.1)
    pub.publish(Twist())


if __name__ == '__main__':
    sys.exit(main())
