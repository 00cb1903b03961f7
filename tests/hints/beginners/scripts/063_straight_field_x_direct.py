import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class S(Node):
    def __init__(self):
        super().__init__('s')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.t = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.x = 1.0
        self.pub.publish(msg)


rclpy.init()
s = S()
rclpy.spin(s)
