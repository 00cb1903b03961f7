>>> import rclpy
>>> from rclpy.node import Node
>>> rclpy.init()
>>> node = Node('hello')
>>> node.get_logger().info('hello')
>>> rclpy.spin(node)
