from concurrent.futures import ThreadPoolExecutor, as_completed
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('pool')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)


def drive(delay, v, w):
    time.sleep(delay)
    msg = Twist()
    msg.linear.x = v
    msg.angular.z = w
    pub.publish(msg)
    return delay


with ThreadPoolExecutor(max_workers=3) as pool:
    jobs = [pool.submit(drive, 1.6, 0.0, 0.0), pool.submit(drive, 0.8, 0.0, 1.0), pool.submit(drive, 0.0, 1.0, 0.0)]
    print([job.result() for job in as_completed(jobs)])
rclpy.shutdown()
