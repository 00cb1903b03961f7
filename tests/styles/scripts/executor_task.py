import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from geometry_msgs.msg import Twist


class Tasks(Node):
    def __init__(self):
        super().__init__('tasks')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def sleep(self, seconds):
        future = Future()

        def wake():
            self.destroy_timer(timer)
            future.set_result(None)

        timer = self.create_timer(seconds, wake)
        return future

    async def drive(self):
        for v, w in ((1.0, 0.0), (0.0, 1.0), (1.0, 0.0)):
            msg = Twist()
            msg.linear.x, msg.angular.z = v, w
            self.pub.publish(msg)
            await self.sleep(0.9)
        self.pub.publish(Twist())
        return 'driven'


rclpy.init()
node = Tasks()
executor = SingleThreadedExecutor()
executor.add_node(node)
task = executor.create_task(node.drive)
executor.spin_until_future_complete(task)
print(task.result())
rclpy.shutdown()
