import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareParameter(Node):
    def __init__(self):
        super().__init__('square_parameter')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.side = self.get_parameter('side').value

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for _ in range(4):
            self.drive(1.0, 0.0, self.side)
            self.drive(0.0, 1.0, 1.5708)


def main():
    rclpy.init()
    node = SquareParameter()
    time.sleep(0.5)
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
