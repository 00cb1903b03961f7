import rclpy
from rclpy.node import Node
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point
from std_msgs.msg import Int64


class AddClient(Node):
    def __init__(self):
        super().__init__('add_client')
        # TODO: client, publisher and subscription


def main():
    rclpy.init()
    node = AddClient()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
