import threading

import rclpy
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = rclpy.create_node('rate_node')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 1)
    # create_rate 需要有人 spin，所以开一个线程
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    rate = node.create_rate(20)
    msg = Twist()
    msg.linear.x = 0.6
    for _ in range(80):
        pub.publish(msg)
        rate.sleep()
    msg.linear.x = 0.0
    pub.publish(msg)
    rate.sleep()
    rclpy.shutdown()
    thread.join()


if __name__ == '__main__':
    main()
