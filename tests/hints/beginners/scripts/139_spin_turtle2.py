import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

NAME = 'turtle2'

class Turn(Node):
    def __init__(self):
        super().__init__('turn_' + NAME)
        self.pub = self.create_publisher(Twist, f'/{NAME}/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        cmd = Twist()
        cmd.angular.z = -1.0
        self.pub.publish(cmd)

def main():
    rclpy.init()
    try:
        rclpy.spin(Turn())
    except KeyboardInterrupt:
        pass

main()
