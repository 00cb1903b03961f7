import threading
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('thread_straight')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    t = threading.Thread(target=rclpy.spin(node))
    t.start()
    msg = Twist()
    msg.linear.x = 1.0
    for i in range(50):
        pub.publish(msg)
        time.sleep(0.1)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
