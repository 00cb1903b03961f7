import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from turtlesim.action import RotateAbsolute


class Rotator(Node):
    def __init__(self):
        super().__init__('rotator')
        self.client = ActionClient(self, RotateAbsolute, '/turtle1/rotate_absolute')
        self.feedbacks = 0

    def send_goal(self, theta):
        goal = RotateAbsolute.Goal()
        goal.theta = theta
        self.client.wait_for_server()
        self.future = self.client.send_goal_async(goal, feedback_callback=self.on_feedback)
        self.future.add_done_callback(self.on_response)

    def on_response(self, future):
        handle = future.result()
        if not handle.accepted:
            self.get_logger().error('Goal rejected')
            return
        self.get_logger().info('Goal accepted')
        handle.get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        result = future.result().result
        self.get_logger().info(f'delta {result.delta:.1f} feedback {self.feedbacks > 50}')
        rclpy.shutdown()

    def on_feedback(self, msg):
        self.feedbacks += 1
        self.remaining = msg.feedback.remaining


def main(args=None):
    rclpy.init(args=args)
    node = Rotator()
    node.send_goal(2.0)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
