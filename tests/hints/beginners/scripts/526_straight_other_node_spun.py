import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.move)

    def move(self):
        cmd = Twist()
        cmd.linear.x = 0.5
        self.pub.publish(cmd)

def main():
    rclpy.init()
    node = rclpy.create_node('straight')
    mover = Mover()
    rclpy.spin(node)

main()
