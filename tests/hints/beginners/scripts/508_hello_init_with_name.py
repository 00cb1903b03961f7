import rclpy

def main():
    rclpy.init('hello_node')
    node = rclpy.create_node('hello_node')
    node.get_logger().info('hello')
    rclpy.spin(node)

main()
