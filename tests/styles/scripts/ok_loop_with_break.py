import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('ok_loop')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    begin = time.time()
    try:
        while rclpy.ok():
            t = time.time() - begin
            if t > 3.0:
                break
            twist = Twist()
            twist.linear.x = 0.7
            twist.angular.z = 0.7
            pub.publish(twist)
            time.sleep(0.1)
    finally:
        pub.publish(Twist())
        node.destroy_node()
        rclpy.try_shutdown()
        rclpy.try_shutdown()


main()
