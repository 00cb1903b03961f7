import threading
import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('guarded')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
pending = []


def obey():
    v, w = pending.pop(0)
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    pub.publish(msg)


guard = node.create_guard_condition(obey)


def commander():
    for command in ((1.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, 0.0)):
        pending.append(command)
        guard.trigger()
        time.sleep(0.9)
    rclpy.shutdown()


threading.Thread(target=commander).start()
rclpy.spin(node)
print('spin returned')
