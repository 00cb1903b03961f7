import sched
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('scheduled')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
scheduler = sched.scheduler(time.monotonic, time.sleep)


def send(v, w):
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    pub.publish(msg)


for k in range(4):
    scheduler.enter(0.5 * k, 1, send, (1.0, 0.0))
scheduler.enter(2.0, 1, send, kwargs={'v': 0.0, 'w': 2.0})
scheduler.enter(2.5, 1, send, (0.0, 0.0))
scheduler.run()
