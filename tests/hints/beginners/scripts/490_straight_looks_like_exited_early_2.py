import sys
try:
    import rclpy
    from geometry_msgs.msg import Twist
except ImportError:
    sys.exit('请先 source ROS 2')
def main():
    rclpy.init(); n=rclpy.create_node('s'); p=n.create_publisher(Twist,'/turtle1/cmd_vel',10)
    def cb():
        m=Twist(); m.linear.x=1.0; p.publish(m)
    n.create_timer(0.1,cb); rclpy.spin_once(n, timeout_sec=0.05)
main()
