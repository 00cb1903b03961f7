import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.pub = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_timer(0.1, self.go)

    def go(self):
        t = Twist()
        t.linear.x = 1.0
        self.pub.publish(t)
        self.get_logger().info('前进')

def main():
    rclpy.init()
    r = Robot()
    rclpy.spin(r)

if __name__ == '__main__':
    main()
