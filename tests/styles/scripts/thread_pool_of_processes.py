from multiprocessing import Lock
from multiprocessing.pool import ThreadPool
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('pool')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
lock = Lock()


def drive(speeds):
    with lock:
        msg = Twist()
        msg.linear.x, msg.angular.z = speeds
        pub.publish(msg)
        time.sleep(0.75)


with ThreadPool(2) as pool:
    pool.map(drive, [(1.0, 0.0), (0.0, 1.0)] * 2, chunksize=4)
pub.publish(Twist())
