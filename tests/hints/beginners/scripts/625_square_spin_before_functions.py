import rclpy
from geometry_msgs.msg import Twist
import time

rclpy.init()
node = rclpy.create_node('my_square')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
rclpy.spin(node)


def move(speed, seconds):
    twist = Twist()
    twist.linear.x = speed
    end = time.time() + seconds
    while time.time() < end:
        pub.publish(twist)
        time.sleep(0.02)


def turn(speed, seconds):
    twist = Twist()
    twist.angular.z = speed
    end = time.time() + seconds
    while time.time() < end:
        pub.publish(twist)
        time.sleep(0.02)


def stop():
    pub.publish(Twist())
    time.sleep(0.5)


for i in range(4):
    move(1.0, 2.0)
    stop()
    turn(0.5, 3.1416)
    stop()

print('done')
node.destroy_node()
rclpy.shutdown()
