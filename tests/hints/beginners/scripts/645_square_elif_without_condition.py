import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Q(Node):
    def __init__(self):
        super().__init__('q')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.plan = ['go', 'turn'] * 4
        self.index = 0
        self.left = 2.0
        self.create_timer(0.02, self.tick)
    def tick(self):
        m = Twist()
        if self.index < len(self.plan):
            if self.plan[self.index] == 'go':
                m.linear.x = 1.0
            elif:
                m.angular.z = 1.0
            self.left -= 0.02
            if self.left <= 0:
                self.index += 1
                self.left = 2.0 if self.index % 2 == 0 else 1.5708
        self.pub.publish(m)
rclpy.init()
rclpy.spin(Q())
