#!/usr/bin/env python3
"""边走边把位姿记到 CSV 文件，最后读回来检查"""
import csv
import os
from datetime import datetime

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class PoseLogger(Node):
    def __init__(self):
        super().__init__('pose_logger')
        log_dir = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'logs')
        os.makedirs(log_dir, exist_ok=True)
        self.path = os.path.join(log_dir, datetime.now().strftime('pose_%Y%m%d_%H%M%S.csv'))
        self.file = open(self.path, 'w', newline='', encoding='utf-8')
        self.writer = csv.writer(self.file)
        self.writer.writerow(['时间', 'x', 'y', 'theta'])
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.timer = self.create_timer(0.1, self.tick)
        self.ticks = 0

    def on_pose(self, msg):
        now = self.get_clock().now().nanoseconds / 1e9
        self.writer.writerow([f'{now:.2f}', f'{msg.x:.3f}', f'{msg.y:.3f}', f'{msg.theta:.3f}'])

    def tick(self):
        self.ticks += 1
        msg = Twist()
        if self.ticks <= 20:
            msg.linear.x = 1.0
        self.pub.publish(msg)
        if self.ticks > 20:
            raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    node = PoseLogger()
    try:
        rclpy.spin(node)
    except SystemExit:
        pass
    finally:
        node.file.close()
        node.destroy_node()
        rclpy.shutdown()
    with open(node.path, encoding='utf-8') as f:
        rows = list(csv.DictReader(f))
    print(os.path.relpath(node.path), len(rows) > 100, float(rows[-1]['x']) - float(rows[0]['x']) > 1.9)


if __name__ == '__main__':
    main()
