import time, math
import rclpy
from geometry_msgs.msg import Twist


def ask():
    while True:
        text = input('边长（米）：').strip().replace('，', '.')
        try:
            value = float(text)
        except ValueError:
            print('请输入数字！')
            continue
        if value > 0:
            return value
        print('必须大于0')


side = ask()
print(f'好的，边长 {side} 米')

rclpy.init()
node = rclpy.create_node('input_square')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
while pub.get_subscription_count() == 0:
    time.sleep(0.1)

for v, w, t in [(1.0, 0.0, side), (0.0, math.pi / 2, 1.0)] * 4:
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    end = time.time() + t
    while time.time() < end:
        pub.publish(m)
        time.sleep(0.01)
    pub.publish(Twist())
    time.sleep(0.1)
rclpy.shutdown()
