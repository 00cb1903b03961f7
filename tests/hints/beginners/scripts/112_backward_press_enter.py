import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Back(Node):
    def __init__(self):
        super().__init__('back')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def move(self):
        msg = Twist()
        msg.linear.x = -1.0
        t = time.time()
        while time.time() - t < 2:
            self.pub.publish(msg)
            time.sleep(0.05)
        self.pub.publish(Twist())


rclpy.init()
b = Back()
input('按回车键开始后退...')
b.move()
print('完成')
