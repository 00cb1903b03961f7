import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Speed(Node):
    def __init__(self):
        super().__init__('speed_node')
        # TODO: parameters, a callback, a publisher and a timer


def main():
    rclpy.init()
    node = Speed()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
