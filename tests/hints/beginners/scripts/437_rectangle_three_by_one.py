# 不用类，只用函数
import math
import time
import rclpy
from geometry_msgs.msg import Twist

V = 0.8
W = 0.8


def run(pub, v, w, t):
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    t0 = time.time()
    while time.time() - t0 < t:
        pub.publish(m)
        time.sleep(0.02)


def halt(pub):
    pub.publish(Twist())
    time.sleep(0.2)


def main():
    rclpy.init()
    node = rclpy.create_node('huatu')
    pub = node.create_publisher(Twist, 'turtle1/cmd_vel', 10)
    time.sleep(1.0)
    for k in range(4):
        run(pub, V, 0.0, (3.0 if k % 2 == 0 else 1.0) / V)
        halt(pub)
        run(pub, 0.0, W, math.pi / 2 / W)
        halt(pub)
    node.get_logger().info('画完了')
    node.destroy_node()
    rclpy.shutdown()


main()
