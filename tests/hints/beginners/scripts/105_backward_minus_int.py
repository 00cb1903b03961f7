import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class B(Node):
    def __init__(self):
        super().__init__('b')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_tick)

    def on_tick(self):
        twist = Twist()
        twist.linear.x = -1
        twist.angular.z = 0
        self.pub.publish(twist)

def main():
    rclpy.init()
    rclpy.spin(B())

if __name__ == '__main__':
    main()
