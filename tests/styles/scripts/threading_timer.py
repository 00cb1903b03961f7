import threading
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class TimerThread(Node):
    def __init__(self):
        super().__init__('timer_thread')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = 1.0
        self.create_timer(0.1, self.publish)
        threading.Timer(2.05, self.halt).start()

    def publish(self):
        msg = Twist()
        msg.linear.x = self.speed
        self.pub.publish(msg)

    def halt(self):
        self.speed = 0.0


rclpy.init()
node = TimerThread()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
