import rclpy
from rclpy.action import ActionClient
from turtlesim.action import RotateAbsolute
rclpy.init(); n=rclpy.create_node('s')
a=ActionClient(n,RotateAbsolute,'/turtle1/rotate_absolute'); a.wait_for_server(); f=a.send_goal_async(RotateAbsolute.Goal(theta=6.283)); rclpy.spin_until_future_complete(n,f)
r=f.result().get_result_async(); rclpy.spin_until_future_complete(n,r)
