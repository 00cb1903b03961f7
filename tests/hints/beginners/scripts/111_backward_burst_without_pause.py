import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('back')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    msg = Twist()
    msg.linear.x = -1.0
    for i in range(20):      # 后退2秒
        pub.publish(msg)
    msg.linear.x = 0.0
    pub.publish(msg)
    time.sleep(1)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
