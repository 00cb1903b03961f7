import rclpy
import time
from geometry_msgs.msg import Twist

jiedian = None
fabuzhe = None
kaishi = time.time()


def chushihua():
    global jiedian, fabuzhe
    rclpy.init()
    jiedian = rclpy.create_node('zheng_fang_xing')
    fabuzhe = jiedian.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)


def zou(sudu, shijian):
    xiaoxi = Twist()
    xiaoxi.linear.x = sudu
    while time.time() - kaishi < shijian:
        fabuzhe.publish(xiaoxi)
        time.sleep(0.02)


def zhuan(jiaosudu, shijian):
    xiaoxi = Twist()
    xiaoxi.angular.z = jiaosudu
    kaishi = time.time()
    while time.time() - kaishi < shijian:
        fabuzhe.publish(xiaoxi)
        time.sleep(0.02)


def ting():
    fabuzhe.publish(Twist())
    time.sleep(0.2)


def main():
    chushihua()
    for i in range(4):
        zou(1.0, 2.0)
        ting()
        zhuan(1.0, 1.5708)
        ting()
    jiedian.destroy_node()
    rclpy.shutdown()


main()
