import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Fast(Node):
    def __init__(self):
        super().__init__('fast')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.02, self.run)
    def run(self):
        msg = Twist()
        msg.linear.x = 10.0   # 越快越好！
        self.pub.publish(msg)

rclpy.init()
rclpy.spin(Fast())
