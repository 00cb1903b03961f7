import rclpy
import time
from geometry_msgs.msg import Twist

def qianjin(fabuqi, juli, sudu=1.0):
    xiaoxi = Twist()
    xiaoxi.linear.x = sudu
    cishu = round(juli / sudu * 10)
    for i in range(cishu):
        fabuqi.publish(xiaoxi)
        time.sleep(0.1)
    fabuqi.publish(Twist())
    time.sleep(0.3)

def zhuanwan(fabuqi):
    # 120度 = 2.0944 弧度, 用 2 秒 转完
    xiaoxi = Twist()
    xiaoxi.angular.z = 1.0472
    for i in range(20):
        fabuqi.publish(xiaoxi)
        time.sleep(0.1)
    fabuqi.publish(Twist())
    time.sleep(0.3)

def main():
    rclpy.init()
    jiedian = rclpy.create_node('san_jiao_xing')
    fabuqi = jiedian.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(2)
    for bian in [1, 2, 3]:
        qianjin(fabuqi, 1.5)
        zhuanwan(fabuqi)
    jiedian.get_logger().info('三角形完成')
    jiedian.destroy_node()
    rclpy.shutdown()

main()
