import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class OdomMover(Node):
    def __init__(self):
        super().__init__('odom_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Odometry, '/odom', self.odom_cb, 10)
        self.x0 = None

    def odom_cb(self, odom):
        x = odom.pose.pose.position.x
        if self.x0 is None:
            self.x0 = x
        msg = Twist()
        if x - self.x0 < 2.0:
            msg.linear.x = 1.0
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = OdomMover()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
