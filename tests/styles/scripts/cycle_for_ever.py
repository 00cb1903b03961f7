from itertools import cycle, chain, repeat
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

SIDE, TURN = (1.0, 0.0), (0.0, 2 * math.pi / 3)


class ForEver(Node):
    def __init__(self):
        super().__init__('for_ever')
        self.commands = cycle(chain(repeat(SIDE, 20), repeat(TURN, 10)))
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x, msg.angular.z = next(self.commands)
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = ForEver()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
