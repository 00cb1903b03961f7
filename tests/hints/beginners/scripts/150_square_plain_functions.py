import rclpy
import time
from geometry_msgs.msg import Twist

pub = None

def tingzhi():
    pub.publish(Twist())
    time.sleep(0.2)

def zhixing(mi):
    m = Twist()
    m.linear.x = 1.0
    t = time.time()
    while time.time() < t + mi:
        pub.publish(m)
        time.sleep(0.02)
    tingzhi()

def zuozhuan():
    m = Twist()
    m.angular.z = 0.7854      # π/4，转2秒就是90度
    t = time.time()
    while time.time() < t + 2:
        pub.publish(m)
        time.sleep(0.02)
    tingzhi()

rclpy.init()
jiedian = rclpy.create_node('zhengfangxing')
pub = jiedian.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
zhixing(1.5)
zuozhuan()
zhixing(1.5)
zuozhuan()
zhixing(1.5)
zuozhuan()
zhixing(1.5)
zuozhuan()
rclpy.shutdown()
