import rclpy

rclpy.init()
node = rclpy.create_node()
node.get_logger().info('hello')
rclpy.spin(node)
