"""A parameter with range and callback."""

import rclpy
from rclpy.node import Node
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from std_msgs.msg import Float64


class Speed(Node):
    def __init__(self):
        super().__init__('speed_node')
        limits = FloatingPointRange(from_value=0.0, to_value=2.0)
        self.declare_parameter('speed', 1.0, ParameterDescriptor(floating_point_range=[limits]))
        self.declare_parameter('name', 'turtle')
        self.add_on_set_parameters_callback(self.on_change)
        self.publisher = self.create_publisher(Float64, 'speed', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_change(self, parameters):
        for each in parameters:
            if each.name == 'name' and not each.value:
                return SetParametersResult(successful=False, reason='the name must not be empty')
        return SetParametersResult(successful=True)

    def on_timer(self):
        msg = Float64()
        msg.data = self.get_parameter('speed').value
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Speed()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
