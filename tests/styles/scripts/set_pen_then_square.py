import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen


class PenSquare(Node):
    def __init__(self):
        super().__init__('pen_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.pen = self.create_client(SetPen, '/turtle1/set_pen')
        self.pen.wait_for_service()

    def color(self, r, g, b):
        future = self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))
        rclpy.spin_until_future_complete(self, future)
        return future.done()

    def side(self, n):
        ok = self.color(255 if n % 2 else 0, 0, 255)
        self.get_logger().info(f'第{n + 1}条边 颜色{"成功" if ok else "失败"}')
        for v, w in ((1.0, 0.0), (0.0, math.pi / 2)):
            m = Twist()
            m.linear.x = v
            m.angular.z = w
            self.pub.publish(m)
            time.sleep(0.9999)


rclpy.init()
node = PenSquare()
for n in range(4):
    node.side(n)
node.pub.publish(Twist())
rclpy.shutdown()
