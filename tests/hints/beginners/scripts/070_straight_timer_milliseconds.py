import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class StraightNode(Node):
    def __init__(self):
        super().__init__('straight_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        # 100毫秒发一次
        self.timer = self.create_timer(100, self.callback)
        self.get_logger().info('start')

    def callback(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)

def main():
    rclpy.init()
    node = StraightNode()
    rclpy.spin(node)
    rclpy.shutdown()

if __name__ == '__main__':
    main()
