import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class OneTick(Node):
    def __init__(self):
        super().__init__('one_tick')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.01, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = -1.0
        self.pub.publish(msg)
        self.get_logger().info('后退完成，关闭节点')
        self.destroy_timer(self.timer)
        rclpy.shutdown()


rclpy.init()
node = OneTick()
rclpy.spin(node)
