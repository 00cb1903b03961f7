import rclpy
def main():
    rclpy.init()
    n = rclpy.create_node('hello')
    n.get_logger().info('hi')
    rclpy.spin(n)

def main():
    pass

if __name__ == '__main__':
    main()
