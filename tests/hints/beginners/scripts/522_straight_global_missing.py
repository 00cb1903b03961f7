import rclpy, time
from geometry_msgs.msg import Twist

pub = None

def init_all():
    rclpy.init()
    node = rclpy.create_node('n')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)

def go():
    m = Twist()
    m.linear.x = 1.0
    for i in range(20):
        pub.publish(m)
        time.sleep(0.1)

init_all()
time.sleep(1)
go()
