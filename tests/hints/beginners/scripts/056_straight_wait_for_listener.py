from geometry_msgs.msg import Twist
import rclpy, time

def zou(pub, v, miao):
    """走 miao 秒"""
    m = Twist()
    m.linear.x = float(v)
    t = 0.0
    while t < miao:
        pub.publish(m)
        time.sleep(0.1)
        t += 0.1

def main():
    rclpy.init()
    jiedian = rclpy.create_node('zou')
    pub = jiedian.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    # 没有人听就先等
    while pub.get_subscription_count() == 0:
        time.sleep(0.1)
    zou(pub, 1, 1)
    zou(pub, 2, 1)
    zou(pub, 0, 0.3)

main()
