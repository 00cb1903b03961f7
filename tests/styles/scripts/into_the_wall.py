import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Wall(Node):
    def __init__(self):
        super().__init__('wall')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.n += 1
        msg = Twist()
        if self.n <= 40:
            msg.linear.x = 2.0
        elif self.n <= 60:
            msg.linear.x = -2.0
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Wall())
