import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class SlowSpin(Node):
    def __init__(self):
        super().__init__('slow_spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.t)

    def t(self):
        a = Twist()
        a.angular.z = 0.1
        self.pub.publish(a)
        self.get_logger().info('慢慢转...')

rclpy.init()
rclpy.spin(SlowSpin())
