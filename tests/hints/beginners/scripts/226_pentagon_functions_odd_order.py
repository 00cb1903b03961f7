def main():
    start()
    wubianxing(5, 2.0)
    finish()


def wubianxing(n, bian):
    k = 0
    while True:
        if k >= n:
            break
        zou(bian)
        guai(360.0 / n)
        k = k + 1


def zou(mi):
    fa(1.0, 0.0, mi / 1.0)


def guai(du):
    # 度数换成弧度再除以角速度
    fa(0.0, -0.9, du * 3.14159265 / 180.0 / 0.9)


def fa(v, w, s):
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    t = time.time() + s
    while time.time() < t:
        quan['pub'].publish(m)
        time.sleep(0.01)
    quan['pub'].publish(Twist())
    time.sleep(0.1)


def start():
    rclpy.init()
    quan['node'] = rclpy.create_node('wu')
    quan['pub'] = quan['node'].create_publisher(Twist, '/turtle1/cmd_vel', 10)
    time.sleep(1)


def finish():
    quan['node'].get_logger().info('完')
    rclpy.shutdown()


quan = {}
import time
import rclpy
from geometry_msgs.msg import Twist

main()
