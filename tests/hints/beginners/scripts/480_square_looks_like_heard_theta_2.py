import rclpy, math, time
from geometry_msgs.msg import Twist
from turtlesim.srv import TeleportAbsolute
rclpy.init(); n=rclpy.create_node('s'); p=n.create_publisher(Twist,'/turtle1/cmd_vel',10); time.sleep(0.5)
def mv(v,w,t):
    m=Twist(); m.linear.x=float(v); m.angular.z=float(w); e=time.time()+t
    while time.time()<e: p.publish(m); time.sleep(0.01)
    p.publish(Twist())
req = TeleportAbsolute.Request()
req.x = 3.0
req.y = 3.0
req.theta = 0.0
c=n.create_client(TeleportAbsolute,'/turtle1/teleport_absolute'); c.wait_for_service(); rclpy.spin_until_future_complete(n,c.call_async(req))
for i in range(4): mv(1,0,2); mv(0,20,1)
