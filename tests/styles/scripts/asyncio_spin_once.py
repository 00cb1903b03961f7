import asyncio
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class N(Node):
    def __init__(self):
        super().__init__('aio')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = 0.0
        self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = self.speed
        self.pub.publish(msg)


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.01)


async def script(node):
    node.speed = 1.0
    await asyncio.sleep(1.55)
    node.speed = -1.0
    await asyncio.sleep(1.0)
    node.speed = 0.0
    await asyncio.sleep(0.2)
    rclpy.shutdown()


def main():
    rclpy.init()
    node = N()
    loop = asyncio.new_event_loop()
    loop.run_until_complete(both(node))
    loop.close()


async def both(node):
    await asyncio.gather(spin(node), script(node))


main()
