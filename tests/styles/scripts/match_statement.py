import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Matcher(Node):
    def __init__(self):
        super().__init__('matcher')
        self.program = ['F', 'F', 'L', 'B', 'R', 'F', 'S']
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(1.0, self.next)

    def next(self):
        twist = Twist()
        match self.program.pop(0):
            case 'F':
                twist.linear.x = 1.0
            case 'B':
                twist.linear.x = -1.0
            case 'L':
                twist.angular.z = 1.0
            case 'R':
                twist.angular.z = -1.0
            case 'S':
                self.timer.cancel()
        self.pub.publish(twist)


rclpy.init()
rclpy.spin(Matcher())
