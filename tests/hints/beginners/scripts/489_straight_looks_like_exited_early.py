import sys, rclpy
from geometry_msgs.msg import Twist
def usage():
    print('用法: straight.py 速度')
    sys.exit(1)
def main():
    if len(sys.argv) > 2:
        usage()
    rclpy.init(); n=rclpy.create_node('s'); p=n.create_publisher(Twist,'/turtle1/cmd_vel',10)
    def cb():
        m=Twist(); m.linear.x=1.0; p.publish(m)
    n.create_timer(0.1,cb); rclpy.spin(n)
