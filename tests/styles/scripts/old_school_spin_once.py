import rclpy
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = rclpy.create_node('old_school')
    pub = node.create_publisher(Twist, 'turtle1/cmd_vel', 10)
    counter = [0]

    def tick():
        counter[0] += 1
        msg = Twist()
        msg.linear.x = -1.0
        pub.publish(msg)

    timer = node.create_timer(0.25, tick)
    while rclpy.ok() and counter[0] < 8:
        rclpy.spin_once(node)
    node.destroy_timer(timer)
    pub.publish(Twist())
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
