import logging
import time
import traceback
import rclpy
from geometry_msgs.msg import Twist

logging.basicConfig(level=logging.INFO, format='%(levelname)s:%(message)s')
log = logging.getLogger('mine')
rclpy.init()
node = rclpy.create_node('mixed_logs')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
try:
    msg = Twist()
    msg.angular.z = 1.0
    for _ in range(10):
        pub.publish(msg)
        time.sleep(0.1)
    pub.publsh(Twist())
except AttributeError:
    log.error(traceback.format_exc().splitlines()[-1])
pub.publish(Twist())
print('done', flush=True)
