import signal
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

stop = False


def on_sigint(signum, frame):
    global stop
    print('signal', signum)
    stop = True


class Loop(Node):
    def __init__(self):
        super().__init__('loop')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)


rclpy.init()
signal.signal(signal.SIGINT, on_sigint)
node = Loop()
msg = Twist()
msg.linear.x = 0.5
while not stop:
    node.pub.publish(msg)
    rclpy.spin_once(node, timeout_sec=0.1)
node.pub.publish(Twist())
print('context ok:', rclpy.ok())
node.destroy_node()
rclpy.shutdown()
