"""The corpus as students' scripts: the same legs in many styles."""

import math

from tests.corpus.attempts import Attempt

_HEAD = """\
import math
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

LEGS = {legs}
TICK = {tick}
FOR_EVER = {for_ever}
STOPS = {stops}


def twist(v, w):
    msg = Twist()
    msg.linear.x, msg.angular.z = float(v), float(w)
    return msg

"""

_RUN = """
def run(node, pub, drive):
    time.sleep(0.3)
    while True:
        for seconds, v, w in LEGS:
            drive(seconds, v, w)
        if not FOR_EVER:
            break
    if STOPS:
        pub.publish(twist(0, 0))

"""

_MAIN = """
rclpy.init()
node = Node('mover')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
run(node, pub, drive)
node.destroy_node()
rclpy.shutdown()
"""

_SLEEP_LOOP = """
def drive(seconds, v, w):
    end = time.monotonic() + seconds
    while time.monotonic() < end - 1e-6:
        pub.publish(twist(v, w))
        time.sleep(TICK)
"""

_CLOCK_LOOP = """
def drive(seconds, v, w):
    start = node.get_clock().now()
    while (node.get_clock().now() - start).nanoseconds < seconds * 1e9 - 1e3:
        pub.publish(twist(v, w))
        time.sleep(TICK)
"""

_SPIN_ONCE = """
def drive(seconds, v, w):
    ticks = math.ceil(seconds / TICK - 1e-6)
    for _ in range(ticks):
        pub.publish(twist(v, w))
        rclpy.spin_once(node, timeout_sec=TICK)
"""

_RATE = """
rclpy.init()
node = Node('mover')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
rate = node.create_rate(1.0 / TICK)


def drive(seconds, v, w):
    for _ in range(math.ceil(seconds / TICK - 1e-6)):
        pub.publish(twist(v, w))
        rate.sleep()


run(node, pub, drive)
rclpy.shutdown()
"""

_TIMER = """
class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.leg, self.ticks = 0, 0
        self.timer = self.create_timer(TICK, self.tick)

    def tick(self):
        if self.leg >= len(LEGS):
            if STOPS:
                self.pub.publish(twist(0, 0))
            self.timer.cancel()
            return
        seconds, v, w = LEGS[self.leg]
        self.pub.publish(twist(v, w))
        self.ticks += 1
        if self.ticks >= math.ceil(seconds / TICK - 1e-6):
            self.leg, self.ticks = self.leg + 1, 0
            if FOR_EVER:
                self.leg %= len(LEGS)


rclpy.init()
rclpy.spin(Mover())
"""

_CHAIN = """
class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.queue = list(LEGS)
        self.end = None
        self.create_timer(TICK, self.work)

    def work(self):
        now = self.get_clock().now().nanoseconds
        if self.end is None or now >= self.end - 1000:
            if not self.queue and FOR_EVER:
                self.queue = list(LEGS)
            if not self.queue:
                if STOPS:
                    self.pub.publish(twist(0, 0))
                raise SystemExit
            seconds, self.v, self.w = self.queue.pop(0)
            self.end = (self.end or now) + int(seconds * 1e9)
        self.pub.publish(twist(self.v, self.w))


rclpy.init()
rclpy.spin(Mover())
"""

_CLOSED = """
class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose


def off(a, b):
    return math.atan2(math.sin(a - b), math.cos(a - b))


rclpy.init()
node = Mover()
while node.pose is None:
    rclpy.spin_once(node)
heading = node.pose.theta


def send(v, w):
    node.pub.publish(twist(v, w))
    rclpy.spin_once(node)


def drive(seconds, v, w):
    global heading
    if v:
        x, y, length = node.pose.x, node.pose.y, abs(v) * seconds
        while True:
            left = length - math.hypot(node.pose.x - x, node.pose.y - y)
            if left < 0.003:
                break
            send(math.copysign(min(abs(v), 4.0 * left + 0.02), v), 2.0 * off(heading, node.pose.theta))
    elif w:
        heading += w * seconds
        while abs(off(heading, node.pose.theta)) > 0.005:
            wanted = 4.0 * off(heading, node.pose.theta)
            send(0.0, max(-abs(w), min(abs(w), wanted)))
    else:
        until = time.time() + seconds
        while time.time() < until:
            send(0.0, 0.0)
    send(0.0, 0.0)


run(node, node.pub, drive)
rclpy.shutdown()
"""

_BODIES = {
    "sleep loop": _RUN + _SLEEP_LOOP + _MAIN,
    "clock loop": _RUN + _CLOCK_LOOP + _MAIN,
    "spin_once loop": _RUN + _SPIN_ONCE + _MAIN,
    "rate in a thread": _RUN + _RATE,
    "timer": _TIMER,
    "callback chain": _CHAIN,
    "closed loop": _RUN + _CLOSED,
}


def script(attempt: Attempt) -> str:
    """Return the attempt as a script."""
    head = _HEAD.format(
        legs=[tuple(round(value, 9) for value in leg) for leg in attempt.legs],
        tick=attempt.tick_s,
        for_ever=attempt.for_ever,
        stops=attempt.stops,
    )
    return head + _BODIES[attempt.style]


def ideal_legs(attempt: Attempt) -> list[tuple[float, float, float]]:
    """Return the legs as a loop of the attempt's tick drives them: each lasts whole ticks."""
    if attempt.style == "closed loop":
        return list(attempt.legs)
    tick_s = attempt.tick_s
    return [(math.ceil(seconds / tick_s - 1e-6) * tick_s, v, w) for seconds, v, w in attempt.legs]
