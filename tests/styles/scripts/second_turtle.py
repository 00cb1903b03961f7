"""教程里的第二只小乌龟：先建发布者，再 spawn，跟在 turtle1 后面。"""
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Kill, SetPen, Spawn


class Follower(Node):
    def __init__(self):
        super().__init__('follower')
        self.leader = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.pub = self.create_publisher(Twist, '/turtle2/cmd_vel', 10)
        self.poses = {}
        for name in ('turtle1', 'turtle2'):
            self.create_subscription(Pose, f'/{name}/pose', lambda pose, name=name: self.on_pose(name, pose), 10)
        self.ticks = 0
        self.spawn = self.create_client(Spawn, '/spawn')
        self.spawn.wait_for_service()
        self.get_logger().info(f'subscribers before: {self.pub.get_subscription_count()}')
        self.spawn.call_async(Spawn.Request(x=2.0, y=2.0, theta=0.0, name='turtle2')).add_done_callback(self.born)

    def born(self, future):
        self.get_logger().info(f'{future.result().name}: {self.pub.get_subscription_count()} subscriber')
        pen = self.create_client(SetPen, '/turtle2/set_pen')
        assert pen.service_is_ready()
        pen.call_async(SetPen.Request(r=255, off=0))
        self.timer = self.create_timer(0.1, self.tick)

    def on_pose(self, name, pose):
        self.poses[name] = pose

    def tick(self):
        self.ticks += 1
        msg = Twist()
        if self.ticks <= 20:
            msg.linear.x = 1.0
        self.leader.publish(msg)
        if len(self.poses) < 2:
            return
        one, two = self.poses['turtle1'], self.poses['turtle2']
        far = math.hypot(one.x - two.x, one.y - two.y)
        turn = math.atan2(one.y - two.y, one.x - two.x) - two.theta
        chase = Twist()
        if far > 0.5:
            chase.linear.x = 1.5
            chase.angular.z = 2.0 * math.atan2(math.sin(turn), math.cos(turn))
        self.pub.publish(chase)
        if far <= 0.5 and self.ticks > 20:
            self.get_logger().info('caught')
            self.timer.cancel()
            self.create_client(Kill, '/kill').call_async(Kill.Request(name='turtle2')).add_done_callback(self.gone)

    def gone(self, _):
        topics = [name for name, _ in self.get_topic_names_and_types()]
        self.get_logger().info(f"gone: {'/turtle2/color_sensor' not in topics} {self.pub.get_subscription_count()}")
        raise SystemExit


def main():
    rclpy.init()
    node = Follower()
    try:
        rclpy.spin(node)
    except SystemExit:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
