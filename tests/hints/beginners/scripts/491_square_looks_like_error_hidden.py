import rclpy, math, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
class S(Node):
    def __init__(self):
        super().__init__('s'); self.p=self.create_publisher(Twist,'/turtle1/cmd_vel',10); self.pose=None
        self.create_subscription(Pose,'/turtle1/pose',self.cb,10)
    def cb(self,m): self.pose=m
    def run(self):
        while self.pose is None:
            time.sleep(0.1)
        m=Twist(); m.linear.x=1.0
        for i in range(20): self.p.publish(m); time.sleep(0.1)
def main():
    rclpy.init(); n=S()
    try:
        n.run()
    finally:
        try:
            rclpy.shutdown()
        except Exception:
            pass
main()
