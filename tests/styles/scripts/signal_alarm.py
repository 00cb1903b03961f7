import signal
import time
import rclpy
from geometry_msgs.msg import Twist


class TimeIsUp(Exception):
    pass


def handler(signum, frame):
    raise TimeIsUp()


rclpy.init()
node = rclpy.create_node('alarm')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
signal.signal(signal.SIGALRM, handler)
signal.alarm(2)
msg = Twist()
msg.linear.x = 1.0
try:
    while True:
        pub.publish(msg)
        time.sleep(0.1)
except TimeIsUp:
    print('time is up')
pub.publish(Twist())
