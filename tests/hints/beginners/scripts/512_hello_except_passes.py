import rclpy
from rclpy.node import Node

class Hello(Node):
    def __init__(self):
        super().__init__('hello')
        self.get_loger().info('hello')

def main():
    rclpy.init()
    try:
        node = Hello()
        rclpy.spin(node)
    except:
        pass
    finally:
        rclpy.shutdown()

if __name__ == '__main__':
    main()
