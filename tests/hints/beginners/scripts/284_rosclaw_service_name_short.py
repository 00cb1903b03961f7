import rclpy
from rclpy.node import Node
from rosclaw_msgs.srv import GetCapabilities

class Disc(Node):
    def __init__(self):
        super().__init__('rosclaw')
        self.create_service(GetCapabilities, '/get_capabilities', self.cb)
        self.get_logger().info('服务已启动')

    def cb(self, request, response):
        response.capabilities = ['navigation', 'speak', 'camera']
        return response

def main():
    rclpy.init()
    rclpy.spin(Disc())

if __name__ == '__main__':
    main()
