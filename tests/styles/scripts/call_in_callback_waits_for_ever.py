import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty


class Deadlock(Node):
    def __init__(self):
        super().__init__('deadlock')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.cli = self.create_client(Empty, '/clear')
        self.create_timer(0.5, self.cb)

    def cb(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
        self.cli.call(Empty.Request())
        print('never reached')


rclpy.init()
rclpy.spin(Deadlock())
