"""The follower."""

import rclpy
from rclpy.node import Node
import math

from geometry_msgs.msg import TransformStamped, Twist
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class Follower(Node):
    def __init__(self):
        super().__init__('follower')
        self.broadcaster = TransformBroadcaster(self)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.poses = [
            self.create_subscription(Pose, f'/{name}/pose', lambda msg, name=name: self.send(name, msg), 10)
            for name in ('turtle1', 'turtle2')
        ]
        self.publisher = self.create_publisher(Twist, '/turtle2/cmd_vel', 10)
        self.client = self.create_client(Spawn, '/spawn')
        self.client.wait_for_service()
        self.client.call_async(Spawn.Request(x=2.0, y=2.0, theta=0.0, name='turtle2'))
        self.timer = self.create_timer(0.1, self.follow)

    def send(self, name, pose):
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = 'world'
        t.child_frame_id = name
        t.transform.translation.x = pose.x
        t.transform.translation.y = pose.y
        t.transform.rotation.z = math.sin(pose.theta / 2)
        t.transform.rotation.w = math.cos(pose.theta / 2)
        self.broadcaster.sendTransform(t)

    def follow(self):
        try:
            t = self.buffer.lookup_transform('turtle2', 'turtle1', rclpy.time.Time())
        except TransformException:
            return
        x, y = t.transform.translation.x, t.transform.translation.y
        msg = Twist()
        msg.linear.x = 1.0 * math.hypot(x, y)
        msg.angular.z = 2.0 * math.atan2(y, x)
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Follower()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
