import rclpy, time, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen, Kill, Spawn, TeleportAbsolute
from std_srvs.srv import Empty


class Draw(Node):
    def __init__(self):
        super().__init__('draw')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.pen = self.create_client(SetPen, '/turtle1/set_pen')
        while not self.pen.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('等待服务')
        req = SetPen.Request
        req.r = 255
        req.width = 3
        future = self.pen.call_async(req)
        rclpy.spin_until_future_complete(self, future)

    def send(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


rclpy.init()
n = Draw()
for i in range(4):
    n.send(1.0, 0.0, 2.0)
    n.send(0.0, 1.0, math.pi / 2)
rclpy.shutdown()
