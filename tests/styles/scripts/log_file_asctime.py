import logging
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import Twist

logging.basicConfig(filename='square.log', level=logging.DEBUG, format='%(asctime)s %(levelname)s %(message)s')
log = logging.getLogger('square')

rclpy.init()
node = rclpy.create_node('square')
pub = node.create_publisher(Twist, 'turtle1/cmd_vel', 10)


def move(v, w, seconds):
    log.info('v=%.1f w=%.2f', v, w)
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    end = time.time() + seconds
    while time.time() < end:
        pub.publish(msg)
        time.sleep(0.02)


for i in range(4):
    move(1.0, 0.0, 1.0)
    move(0.0, 1.5708, 1.0)
pub.publish(Twist())
lines = Path('square.log').read_text().splitlines()
print(len(lines), lines[0].split(' ', 2)[2])
