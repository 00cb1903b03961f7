import threading
from time import sleep
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('nd')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)


def drive():
    m = Twist()
    m.linear.x = 1.0
    for _ in range(30):
        pub.publish(m)
        sleep(0.1)
    pub.publish(Twist())
    print('worker finished')


threading.Thread(target=drive).start()
print('main finished')
