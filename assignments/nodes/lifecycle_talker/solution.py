"""A lifecycle node."""

import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class LifecycleTalker(LifecycleNode):
    def __init__(self):
        super().__init__('lifecycle_talker')
        self.publisher = None
        self.timer = None
        self.count = 0

    def on_configure(self, state):
        self.publisher = self.create_lifecycle_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.on_timer)
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.destroy_publisher(self.publisher)
        return TransitionCallbackReturn.SUCCESS

    def on_timer(self):
        if self.publisher is not None and self.publisher.is_activated:
            msg = String()
            msg.data = f'Hello World: {self.count}'
            self.count += 1
            self.publisher.publish(msg)


def main():
    rclpy.init()
    node = LifecycleTalker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
