import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


def main():
    rclpy.init()
    node = Node('mover')
    pub = node.create_publisher(Twist, '/turtlel/cmd_vel', 10)
    time.sleep(1.0)
    vel = Twist()
    vel.linear.x = 1.0
    for i in range(30):
        pub.publish(vel)
        print('第', i, '次发布')
        time.sleep(0.1)
    pub.publish(Twist())
    rclpy.shutdown()


if __name__ == '__main__':
    main()
