import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

SPEED = 1.0

class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear = SPEED
        msg.angular = 0.0
        self.publisher.publish(msg)

def main():
    rclpy.init()
    node = Mover()
    rclpy.spin(node)

if __name__ == '__main__':
    main()
