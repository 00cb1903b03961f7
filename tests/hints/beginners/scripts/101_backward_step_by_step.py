import rclpy, time
from geometry_msgs.msg import Twist

rclpy.init()
n = rclpy.create_node('stepper')
p = n.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1.5)

def step():
    "退一小步，停一下"
    m = Twist(); m.linear.x = -0.8
    for _ in range(5): p.publish(m); time.sleep(0.1)
    p.publish(Twist()); time.sleep(0.5)

step(); step(); step(); step()
print("退完了")
rclpy.shutdown()
