import rclpy
from rclpy.node import Node
from turtlesim.msg import Pose

class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Pose, '/turtle1/pose', 10)
        self.create_timer(0.1, self.move)
        self.x = 5.5

    def move(self):
        self.x += 0.1
        p = Pose()
        p.x = self.x
        p.y = 5.5
        self.pub.publish(p)

def main():
    rclpy.init()
    rclpy.spin(Mover())

main()
