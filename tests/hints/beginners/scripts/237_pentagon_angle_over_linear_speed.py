import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class PentagonMover(Node):
    def __init__(self):
        super().__init__('pentagon_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 0.5
        self.TURN_SPEED = 1.0
        self.MOVE_TIME = 1.5 / self.SPEED
        self.TURN_TIME = 1.257 / self.SPEED

    def go(self, v, w, d):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        t = time.time() + d
        while time.time() < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    node = PentagonMover()
    time.sleep(1)
    for i in range(5):
        node.go(node.SPEED, 0.0, node.MOVE_TIME)
        node.go(0.0, node.TURN_SPEED, node.TURN_TIME)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
