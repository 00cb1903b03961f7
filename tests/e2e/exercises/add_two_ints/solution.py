import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Add(Node):
    def __init__(self):
        super().__init__("add_two_ints_server")
        self.srv = self.create_service(AddTwoInts, "add_two_ints", self.cb)

    def cb(self, req, res):
        res.sum = req.a + req.b
        self.get_logger().info(f"{req.a} + {req.b}")
        return res


def main():
    rclpy.init()
    n = Add()
    try:
        rclpy.spin(n)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
