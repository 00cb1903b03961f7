// 第一个节点
import rclpy;
from rclpy.node import Node;

class HelloNode(Node) {
    def __init__(self) {
        super().__init__('hello_node');
        self.get_logger().info('hello');
    }
}

int main() {
    rclpy.init();
    rclpy.spin(HelloNode());
    return 0;
}
