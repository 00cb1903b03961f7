import queue
import threading
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

commands = queue.Queue(maxsize=2)


class Worker(Node):
    def __init__(self):
        super().__init__('worker')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def work(self):
        while True:
            try:
                item = commands.get(timeout=1.5)
            except queue.Empty:
                self.get_logger().warn('nothing to do')
                break
            v, w, seconds = item
            msg = Twist()
            msg.linear.x = v
            msg.angular.z = w
            self.pub.publish(msg)
            time.sleep(seconds)
            commands.task_done()
        self.pub.publish(Twist())


rclpy.init()
node = Worker()
thread = threading.Thread(target=node.work)
thread.start()
for item in [(1.0, 0.0, 1.0), (0.0, 1.0, 0.5), (1.0, 0.0, 0.5), (0.0, -1.0, 1.0)]:
    commands.put(item)
commands.join()
print('all done')
thread.join()
rclpy.shutdown()
