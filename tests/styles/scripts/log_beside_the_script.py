import os
import sys
import time
import traceback

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class 日志(Node):
    def __init__(self):
        super().__init__('log_beside')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.file = open(os.path.join(sys.path[0], '记录.txt'), 'w', encoding='utf-8')

    def drive(self, v, w, seconds):
        start = time.time()
        while time.time() - start < seconds:
            msg = Twist()
            try:
                msg.linear.x = v
            except AssertionError:
                self.file.write(traceback.format_exc())
                v = float(v)
                continue
            msg.angular.z = w
            self.pub.publish(msg)
            time.sleep(0.02)


rclpy.init()
node = 日志()
node.drive(1, 0.0, 2.0)
node.drive(0.0, 1.0, 1.5708)
node.drive(1, 0.0, 1.0)
node.pub.publish(Twist())
node.file.close()
with open('记录.txt', encoding='utf-8') as file:
    print(sum(line.startswith('  File') for line in file), '处')
rclpy.shutdown()
