import time
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.action import RotateAbsolute


class Server(Node):
    """An action of our own that turns the turtle by an angle with cmd_vel."""

    def __init__(self):
        super().__init__('turn_server')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.server = ActionServer(self, RotateAbsolute, 'turn_by', self.execute)

    def execute(self, goal_handle):
        self.get_logger().info('executing')
        msg = Twist()
        msg.angular.z = 1.0
        feedback = RotateAbsolute.Feedback()
        steps = round(goal_handle.request.theta / 0.1)
        for i in range(steps):
            self.pub.publish(msg)
            feedback.remaining = goal_handle.request.theta - i * 0.1
            goal_handle.publish_feedback(feedback)
            time.sleep(0.1)
        self.pub.publish(Twist())
        goal_handle.succeed()
        return RotateAbsolute.Result(delta=steps * 0.1)


def main():
    rclpy.init()
    server, client_node = Server(), Node('turn_client')
    client = ActionClient(client_node, RotateAbsolute, 'turn_by')
    executor = MultiThreadedExecutor(4)
    executor.add_node(server)
    executor.add_node(client_node)
    seen = []
    goal = client.send_goal_async(RotateAbsolute.Goal(theta=2.0), feedback_callback=lambda f: seen.append(f.feedback.remaining))
    executor.spin_until_future_complete(goal)
    result = goal.result().get_result_async()
    executor.spin_until_future_complete(result)
    print(f'{result.result().status} {result.result().result.delta:.1f} {len(seen)}')
    executor.shutdown()
    rclpy.shutdown()


main()
