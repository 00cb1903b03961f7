import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy, QoSHistoryPolicy
from geometry_msgs.msg import Twist

rclpy.init()
node = Node('mover', namespace='turtle1')
qos = QoSProfile(reliability=QoSReliabilityPolicy.RELIABLE, history=QoSHistoryPolicy.KEEP_LAST, depth=1)
pub = node.create_publisher(msg_type=Twist, topic='cmd_vel', qos_profile=qos)
node.get_logger().info(pub.topic_name)
ticks = 0


def tick():
    global ticks
    ticks += 1
    msg = Twist()
    msg.linear.x = 1.0 if ticks <= 15 else 0.0
    pub.publish(msg)


node.create_timer(0.1, tick)
rclpy.spin(node)
