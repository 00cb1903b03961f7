import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities


class One(Node):
    def __init__(self):
        super().__init__('one')
        self.srv = self.create_service(GetCapabilities, '/rosclaw/get_capabilities', self.cb)

    def cb(self, request, response):
        response.capabilities = ['navigation']
        return response


rclpy.init()
rclpy.spin(One())
