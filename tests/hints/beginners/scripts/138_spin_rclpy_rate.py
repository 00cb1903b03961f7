import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = Node('spin')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    rate = rclpy.Rate(10)
    msg = Twist()
    msg.angular.z = 1.0
    while rclpy.ok():
        pub.publish(msg)
        rate.sleep()


if __name__ == '__main__':
    main()
