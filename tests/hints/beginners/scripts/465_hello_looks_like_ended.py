import rclpy, threading
rclpy.init(); node=rclpy.create_node('hello_node')
node.get_logger().info('你好')
try:
    threading.Event().wait()
except KeyboardInterrupt:
    pass
node.destroy_node()
