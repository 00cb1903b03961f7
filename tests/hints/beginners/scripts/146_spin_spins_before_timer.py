import rclpy
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = rclpy.create_node('spin_me')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def tick():
        m = Twist()
        m.angular.z = 1.0
        pub.publish(m)

    rclpy.spin(node)
    node.create_timer(0.1, tick)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
