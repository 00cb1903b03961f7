import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.move)

    def move(self):
        t = Twist()
        t.linear.x = 0.0005
        self.pub.publish(t)

def main():
    rclpy.init()
    rclpy.spin(Mover())

main()
