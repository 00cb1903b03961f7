import math
import rclpy
from rclpy.node import Node
from rclpy.time import Time
from geometry_msgs.msg import TransformStamped, Twist
from tf2_ros import TransformBroadcaster, TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener
from turtlesim.msg import Pose


class Frames(Node):
    def __init__(self):
        super().__init__('frames')
        self.broadcaster = TransformBroadcaster(self)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 1)
        self.create_timer(0.1, self.control)

    def on_pose(self, pose):
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = 'world'
        t.child_frame_id = 'turtle1'
        t.transform.translation.x = pose.x
        t.transform.translation.y = pose.y
        t.transform.rotation.z = math.sin(pose.theta / 2)
        t.transform.rotation.w = math.cos(pose.theta / 2)
        self.broadcaster.sendTransform(t)

    def control(self):
        try:
            t = self.buffer.lookup_transform('world', 'turtle1', Time())
        except TransformException as ex:
            self.get_logger().info(f'no transform yet: {ex}')
            return
        msg = Twist()
        if t.transform.translation.x < 7.5:
            msg.linear.x = 1.0
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = Frames()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


main()
