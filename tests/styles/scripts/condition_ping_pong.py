import threading
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('ping_pong')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
turn_of = 'straight'
cond = threading.Condition()


def worker(name, other, v, w):
    global turn_of
    for _ in range(2):
        with cond:
            cond.wait_for(lambda: turn_of == name)
            msg = Twist()
            msg.linear.x = v
            msg.angular.z = w
            pub.publish(msg)
            time.sleep(0.75)
            turn_of = other
            cond.notify_all()


threads = [
    threading.Thread(target=worker, args=('turn', 'straight', 0.0, 1.0)),
    threading.Thread(target=worker, args=('straight', 'turn', 1.0, 0.0)),
]
for t in threads:
    t.start()
for t in threads:
    t.join()
pub.publish(Twist())
