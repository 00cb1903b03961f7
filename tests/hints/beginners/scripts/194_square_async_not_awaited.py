import asyncio
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class AsyncSquare(Node):
    def __init__(self):
        super().__init__('async_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    async def cmd(self, v, w, seconds):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        for _ in range(int(seconds * 100)):
            self.pub.publish(m)
            await asyncio.sleep(0.01)
        self.pub.publish(Twist())

    async def run(self):
        await asyncio.sleep(1)
        for _ in range(4):
            await self.cmd(1.0, 0.0, 2.0)
            await self.cmd(0.0, 1.0, 1.5708)


def main():
    rclpy.init()
    node = AsyncSquare()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
