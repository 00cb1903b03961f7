import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

def main():
    rclpy.init()
    node = Node('go')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    msg = Twist()
    msg.linear.x = 1.0
    pub.publish(msg)
    node.get_logger().info('已经发布速度 1.0')
    node.destroy_node()
    rclpy.shutdown()

main()
