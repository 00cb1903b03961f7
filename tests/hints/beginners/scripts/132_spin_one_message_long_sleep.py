import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('spin_node')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)

    msg = Twist()
    msg.angular.z = 1.0
    pub.publish(msg)          # 开始转
    time.sleep(6.28)          # 转一圈的时间
    pub.publish(Twist())      # 停
    time.sleep(0.5)

    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
