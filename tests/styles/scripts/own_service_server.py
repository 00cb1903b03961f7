import threading
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_srvs.srv import SetBool, Trigger


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.enabled = False
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_service(SetBool, 'enable', self.on_enable)
        self.create_timer(0.1, self.loop)

    def on_enable(self, request, response):
        self.enabled = request.data
        response.success = True
        response.message = 'on' if request.data else 'off'
        return response

    def loop(self):
        msg = Twist()
        if self.enabled:
            msg.linear.x = 1.0
            msg.angular.z = -0.5
        self.pub.publish(msg)


rclpy.init()
robot = Robot()
threading.Thread(target=rclpy.spin, args=(robot,), daemon=True).start()
remote = rclpy.create_node('remote')
client = remote.create_client(SetBool, '/enable')
assert client.wait_for_service(timeout_sec=1)
for value, pause in ((True, 2.0), (False, 0.5)):
    future = client.call_async(SetBool.Request(data=value))
    rclpy.spin_until_future_complete(remote, future, executor=rclpy.executors.SingleThreadedExecutor())
    print(future.result().message)
    remote.get_clock().sleep_for(rclpy.duration.Duration(seconds=pause))
rclpy.shutdown()
