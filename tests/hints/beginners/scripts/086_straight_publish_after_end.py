import rclpy
import time
from geometry_msgs.msg import Twist

def main():
    rclpy.init()
    node = rclpy.create_node('p')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)
    node.destroy_node()
    rclpy.shutdown()
    msg = Twist()
    msg.linear.x = 1.0
    for i in range(20):
        pub.publish(msg)
        time.sleep(0.1)

if __name__ == '__main__':
    main()
