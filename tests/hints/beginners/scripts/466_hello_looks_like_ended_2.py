import queue, rclpy
rclpy.init(); n=rclpy.create_node('h'); n.get_logger().info('你好')
queue.Queue().get()
