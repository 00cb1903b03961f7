import rclpy
import time

rclpy.init()
node = rclpy.create_node('laoda')
while True:
    node.get_logger().info('你好！！')
    time.sleep(1)
