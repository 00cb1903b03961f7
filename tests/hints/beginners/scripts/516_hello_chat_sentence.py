好的，下面是一个简单的 ROS2 节点代码：

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node('hello')
node.get_logger().info('hello')
rclpy.spin(node)
