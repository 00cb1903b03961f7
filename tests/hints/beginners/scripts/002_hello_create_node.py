import rclpy

rclpy.init()
n = rclpy.create_node('hi')
n.get_logger().info('hello ros2')
rclpy.spin(n)
