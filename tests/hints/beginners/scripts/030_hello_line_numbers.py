1  import rclpy
2  from rclpy.node import Node
3
4  class HelloNode(Node):
5      def __init__(self):
6          super().__init__('hello_node')
7          self.get_logger().info('Hello ROS2!')
8
9  def main(args=None):
10     rclpy.init(args=args)
11     node = HelloNode()
12     rclpy.spin(node)
13
14 if __name__ == '__main__':
15     main()
