import rclpy
from rosclaw_msgs.srv import GetCapabilities

rclpy.init()
node = rclpy.create_node('rosclaw_discovery')


def handle(request, response):
    for c in ('navigation', 'camera', 'battery'):
        response.capabilities.append(c)
    return response


service = node.create_service(GetCapabilities, 'rosclaw/get_capabilities', handle)
rclpy.spin(node)
