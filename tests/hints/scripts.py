# ruff: noqa: E501 - one script a line, to be compared with its neighbours
"""Scripts as beginners write them: small edits of the course's own, with the cause that must be told first.

An edit replaces a text, which must be there; one whose first half is empty puts the text before the script.
"""

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BASES = {
    "hello": ROOT / "lesson" / "hello_node.py",
    "straight": ROOT / "lesson" / "straight_mover.py",
    "square": ROOT / "lesson" / "square_mover.py",
    "square_input": ROOT / "assignments" / "square_input" / "solution.py",
    "spin": ROOT / "assignments" / "spin" / "solution.py",
    "letter_l": ROOT / "assignments" / "letter_l" / "solution.py",
}

Edit = tuple[str, str]


@dataclass(frozen=True)
class Script:
    """One script. `cause` is its kind (`tests.hints.categories`), empty where no hint may come."""

    name: str
    base: str
    cause: str
    edits: tuple[Edit, ...]
    assignment: str = ""

    @property
    def source(self) -> str:
        text = BASES[self.base].read_text(encoding="utf-8") if self.base else ""
        for old, new in self.edits:
            assert old in text, (self.name, old)
            text = text.replace(old, new) if old else new + text
        return text


def _script(name: str, base: str, cause: str, *edits: Edit, to: str = "") -> Script:
    return Script(name, base, cause, edits, to or base)


_STOP_AT_END = "        self.stop()\n        self.get_logger().info('✓ 旋转完成')\n"
_INIT = "    rclpy.init(args=args)\n"
_TURN = "            self.turn(self.TURN_TIME)\n"
_BARE = (
    "import rclpy, time\nfrom geometry_msgs.msg import Twist\nrclpy.init()\nnode = rclpy.create_node('n')\n"
    "pub_a = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)\ntime.sleep(1)\n"
    "def go(v, w, t):\n    m = Twist()\n    m.linear.x = v\n    m.angular.z = w\n"
    "    for _ in range(round(t * 50)):\n        pub_a.publish(m)\n        time.sleep(0.02)\n"
)

_BY_POSE = (
    "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
    "from turtlesim.srv import SetPen, Spawn\n"
    "class Drive(Node):\n    def __init__(self):\n        super().__init__('drive')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
    "        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n"
    "        self.client = self.create_client(SetPen, '/turtle1/set_pen')\n"
    "        while not self.client.wait_for_service(timeout_sec=1.0):\n            print('waiting')\n"
    "    def on_pose(self, pose):\n        future = self.client.call_async(self.client.srv_type.Request())\n"
    "        msg = Twist()\n        msg.linear.x = 1.0\n        self.pub.publish(msg)\n"
    "rclpy.init()\nrclpy.spin(Drive())\n"
)

_BRAIN = (
    "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom std_msgs.msg import Float64\n"
    "class Brain(Node):\n    def __init__(self):\n        super().__init__('brain')\n"
    "        self.pub = self.create_publisher(Float64, 'speed', 10)\n        self.create_timer(0.1, self.tick)\n"
    "    def tick(self):\n        self.pub.publish(Float64(data=1.0))\n"
    "class Body(Node):\n    def __init__(self):\n        super().__init__('body')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
    "        self.create_subscription(Float64, 'speed', self.on_speed, 10)\n"
    "    def on_speed(self, speed):\n        msg = Twist()\n        msg.linear.x = speed.data\n        self.pub.publish(msg)\n"
    "rclpy.init()\nbrain, body = Brain(), Body()\nex = rclpy.executors.MultiThreadedExecutor()\n"
    "ex.add_node(brain)\nex.add_node(body)\nex.spin()\n"
)

_HELPED = (
    "import rclpy, time\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\n"
    "class Wheels:\n    def __init__(self, node):\n        self.pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
    "    def send(self, v):\n        msg = Twist()\n        msg.linear.x = v\n        self.pub.publish(msg)\n"
    "class Mover(Node):\n    def __init__(self):\n        super().__init__('mover')\n        self.wheels = Wheels(self)\n"
    "        self.create_timer(0.1, self.tick)\n    def tick(self):\n        self.wheels.send(1.0)\n"
    "rclpy.init()\nrclpy.spin(Mover())\n"
)

_CHAIN = (
    "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\n"
    "class Square(Node):\n    def __init__(self):\n        super().__init__('square')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n        self.v, self.w, self.n = 0.0, 0.0, 0\n"
    "        self.create_timer(0.02, self.send)\n        self.t = self.create_timer(1.0, self.forward)\n"
    "    def forward(self):\n        self.t.cancel()\n        if self.n == 4:\n            self.v = self.w = 0.0\n            return\n"
    "        self.n += 1\n        self.v, self.w = 1.0, 0.0\n        self.t = self.create_timer(2.0, self.turn)\n"
    "    def turn(self):\n        self.t.cancel()\n        self.v, self.w = 0.0, 1.0\n        self.t = self.create_timer(1.5708, self.forward)\n"
    "    def send(self):\n        msg = Twist()\n        msg.linear.x = self.v\n        msg.angular.z = self.w\n        self.pub.publish(msg)\n"
    "rclpy.init()\nrclpy.spin(Square())\n"
)

_STEPS = (
    "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\n"
    "class Square(Node):\n    STEPS = [(1.0, 0.0, 2.0), (0.0, 1.0, 1.5708)] * 4\n    def __init__(self):\n        super().__init__('square')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n        self.timer = self.create_timer(0.05, self.tick)\n"
    "        self.i = 0\n        self.start = self.get_clock().now()\n"
    "    def tick(self):\n        msg = Twist()\n        if self.i >= 8:\n            self.timer.cancel()\n            self.pub.publish(msg)\n            return\n"
    "        v, w, seconds = self.STEPS[self.i]\n        elapsed = self.get_clock().now() - self.start\n"
    "        if elapsed.nanoseconds >= seconds:\n            self.i += 1\n            self.start = self.get_clock().now()\n            return\n"
    "        msg.linear.x = v\n        msg.angular.z = w\n        self.pub.publish(msg)\n"
    "def main():\n    rclpy.init()\n    node = Square()\n    rclpy.spin(node)\nmain()\n"
)

_RATED = (
    "import rclpy, threading\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\n"
    "class Mover(Node):\n    def __init__(self):\n        super().__init__('mover')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n        self.rate = self.create_rate(2)\n"
    "    def go(self, v, w, n):\n        msg = Twist()\n        msg.linear.x = v\n        msg.angular.z = w\n"
    "        for k in range(n):\n            self.pub.publish(msg)\n            self.rate.sleep()\n"
    "def main():\n    rclpy.init()\n    mover = Mover()\n    threading.Thread(target=rclpy.spin, args=(mover,), daemon=True).start()\n"
    "    mover.rate.sleep()\n    mover.go(1.0, 0.0, 30)\n    rclpy.shutdown()\nmain()\n"
)

_POINTS = (
    "import math, rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
    "def fold(a):\n    return math.atan2(math.sin(a), math.cos(a))\n"
    "class Square(Node):\n    def __init__(self):\n        super().__init__('square')\n"
    "        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
    "        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n        self.points = None\n        self.k = 0\n"
    "    def on_pose(self, p):\n        if self.points is None:\n            x, y, s = p.x, p.y, 2.0\n"
    "            self.points = [(x + s, y), (x + s, y + s), (x, y + s), (x, y)]\n        m = Twist()\n        if self.k < 4:\n"
    "            gx, gy = self.points[self.k]\n            dist = math.hypot(gx - p.x, gy - p.y)\n"
    "            err = math.atan2(gy - p.y, gx - p.x) - p.theta\n            err = fold(err)\n"
    "            if dist < 0.03:\n                self.k += 1\n            elif abs(err) > 0.02:\n                m.angular.z = 2.0 * err\n"
    "            else:\n                m.linear.x = min(1.0, 1.0 * dist + 0.05)\n                m.angular.z = 0.5 * err\n        self.pub.publish(m)\n"
    "rclpy.init()\nrclpy.spin(Square())\n"
)

_HEARD = (
    "import rclpy, threading, time\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
    "pose = None\ndef on_pose(msg):\n    global pose\n    pose = msg\nrclpy.init()\nnode = Node('mover')\n"
    "pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)\nnode.create_subscription(Pose, '/turtle1/pose', on_pose, 10)\n"
    "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\nwhile pose is None:\n    time.sleep(0.05)\n"
    "x = pose.x\nm = Twist()\nm.linear.x = 1.0\nwhile pose.x < x + 2.0:\n    pub.publish(m)\n    time.sleep(0.02)\n"
    "pub.publish(Twist())\nrclpy.shutdown()\n"
)

SCRIPTS = (
    # Right ones: no hint.
    _script("hello as taught", "hello", ""),
    _script("straight as taught", "straight", ""),
    _script("square as taught", "square", ""),
    _script("square_input as taught", "square_input", ""),
    _script("spin as taught", "spin", ""),
    _script("square other publisher", "square", "", ("self.cmd_vel_pub", "self.fabu")),
    _script("square slower", "square", "", ("self.SPEED = 1.0 ", "self.SPEED = 0.5 ")),
    _script("square to the right", "square", "", ("float(self.TURN_SPEED)", "-float(self.TURN_SPEED)")),
    _script("square sleeps on", "square", "", ("    node.destroy_node()\n", "    time.sleep(1000)\n    node.destroy_node()\n")),
    _script("square spins on", "square", "", ("    node.destroy_node()\n", "    rclpy.spin(node)\n    node.destroy_node()\n")),
    _script("square without last turn", "square", "", (_TURN, "            if i < 3:\n                self.turn(self.TURN_TIME)\n")),
    _script("words in strings", "square", "", ("'🎉 正方形走完!回到起点!'", "'i++ else if import turtle rclpy.shutdown()'")),
    _script("strange but right", "straight", "", ("msg.angular.z = 0.0 ", "msg.angular.z = -0.0 ")),
    _script("shutdown guarded", "straight", "", ("        rclpy.shutdown()", "        if rclpy.ok():\n            rclpy.shutdown()")),
    _script("by pose", "", "", ("", _BY_POSE), to="straight"),
    _script("brain and body", "", "", ("", _BRAIN), to="straight"),
    _script("body not in the executor", "", "silent", ("", _BRAIN), ("ex.add_node(body)", "pass"), to="straight"),
    # What nobody sends.
    _script("pose with a capital", "", "size", ("", _BY_POSE), ("/turtle1/pose", "/turtle1/Pose"), to="straight"),
    _script("pose without the turtle", "", "size", ("", _BY_POSE), ("/turtle1/pose", "pose"), to="straight"),
    _script("time of a simulation", "", "silent", ("", _BRAIN), ("super().__init__('brain')", "super().__init__('brain', parameter_overrides=[rclpy.parameter.Parameter('use_sim_time', value=True)])"), to="straight"),
    _script("topic of nobody", "", "silent", ("", _BY_POSE), ("/turtle1/pose", "/position"), to="straight"),
    _script("service misspelt", "", "size", ("", _BY_POSE), ("'/turtle1/set_pen", "'/turtle1/setpen"), to="straight"),
    _script("service of nobody", "", "task", ("", _BY_POSE), ("'/turtle1/set_pen", "'/battery"), to="straight"),
    _script("client of another type", "", "silent", ("", _BY_POSE), ("(SetPen,", "(Spawn,"), to="straight"),
    _script("spins in a callback", "", "silent", ("", _BY_POSE), ("        msg = Twist()", "        rclpy.spin_until_future_complete(self, future)\n        msg = Twist()"), to="straight"),
    # The order of causes.
    _script("turn behind the loop", "square", "silent", (_TURN, "        " + _TURN.strip() + "\n")),
    _script("turn commented out", "square", "silent", (_TURN, "            # self.turn(self.TURN_TIME)\n")),
    _script("turn rate zero", "square", "size", ("msg.angular.z = float(self.TURN_SPEED)", "msg.angular.z = 0.0"),
            ("range(4)", "range(2)")),
    _script("turning time zero", "square", "size", ("1.5708 / self.TURN_SPEED", "1.5708 * 0")),
    _script("turn returns at once", "square", "size", ("        self.get_logger().info('↻ 旋转...')\n", "        return\n")),
    _script("long straight", "straight", "size", to="square"),
    _script("curved", "straight", "shape", ("msg.angular.z = 0.0", "msg.angular.z = 0.5")),
    _script("curved to the right", "straight", "shape", ("msg.angular.z = 0.0", "msg.angular.z = -1.0")),
    _script("backward", "straight", "size", ("msg.linear.x = 1.0", "msg.linear.x = -1.0")),
    _script("sides too long", "square", "shape", ("self.SIDE_LENGTH = 2.0 ", "self.SIDE_LENGTH = 8.0 ")),
    _script("no stop, then spin", "", "stop",
            ("", _BARE + "go(1.0, 0.0, 2)\nfor _ in range(3):\n    go(0.0, 1.5708, 1)\n    go(1.0, 0.0, 2)\nrclpy.spin(node)\n"), to="square"),
    _script("no stop, then over", "", "stop",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    go(0.0, 1.5708, 1)\n"), to="square"),
    _script("message reused", "", "shape",
            ("", _BARE + "for _ in range(4):\n    go(0.8, 0.0, 2)\n    go(0.8, 1.5708, 1)\npub_a.publish(Twist())\n"), to="square"),
    _script("published once each", "", "size",
            ("", _BARE + "for _ in range(4):\n    m = Twist()\n    m.linear.x = 1.0\n    pub_a.publish(m)\n    time.sleep(2)\n"
             "    m = Twist()\n    m.angular.z = 1.0\n    pub_a.publish(m)\n    time.sleep(1.57)\n"), to="square"),
    _script("too slow", "square", "size", ("self.SPEED = 1.0 ", "self.SPEED = 0.1 ")),
    _script("still on the first side", "square", "size", ("self.SPEED = 1.0 ", "self.SPEED = 0.024 ")),
    _script("degrees", "square", "size", ("float(self.TURN_SPEED)", "90.0")),
    _script("spin first", "square", "silent", ("    node.move_square()\n", "    rclpy.spin(node)\n    node.move_square()\n")),
    _script("executor spins first", "square", "silent",
            ("    node.move_square()\n",
             "    ex = rclpy.executors.SingleThreadedExecutor()\n    ex.add_node(node)\n    ex.spin()\n    node.move_square()\n"),
            ("import time\n", "import time\nimport rclpy.executors\n")),
    _script("milliseconds", "square", "size", ("    time.sleep(1)\n", "    time.sleep(1000)\n")),
    _script("milliseconds in the loop", "square", "size", ("time.sleep(0.01)", "time.sleep(100)")),
    _script("callback without publish", "straight", "silent", ("        self.cmd_vel_pub.publish(msg)\n", "")),
    # What Python says, in the student's language.
    _script("init twice", "square", "error", (_INIT, _INIT + _INIT)),
    _script("init in the node", "straight", "error", ("        # 节点名\n", "        rclpy.init()\n")),
    _script("a string published", "straight", "error", ("publish(msg)", "publish('go')")),
    _script("a vector published", "square", "error", ("        self.cmd_vel_pub.publish(msg)\n        time", "        self.cmd_vel_pub.publish(msg.linear)\n        time")),
    _script("a number published", "straight", "error", ("publish(msg)", "publish(1.0)")),
    _script("no base class", "straight", "error", ("StraightMover(Node)", "StraightMover")),
    _script("no base class, no super", "square", "error", ("SquareMover(Node)", "SquareMover()"), ("        super().__init__('square_mover')\n", "")),
    _script("int of a decimal", "square_input", "error", ("float(input", "int(input")),
    _script("unit read along", "square_input", "error", ("float(input('请输入边长（米）：'))", "float(input() + 'm')")),
    _script("unbound", "square", "error", ("        for i in range(4):\n", "        n = n + 1\n        for i in range(4):\n")),
    _script("shutdown early", "square", "error", ("    node.move_square()\n", "    rclpy.shutdown()\n    node.move_square()\n")),
    _script("destroyed early", "square", "error", ("    node.move_square()\n", "    node.destroy_node()\n    node.move_square()\n")),
    _script("method outside", "square", "error", ("    def move_square(self)", "def move_square(self)")),
    _script("self forgotten", "square", "error", ("self.move_straight(self", "move_straight(self")),
    _script("self no parameter", "square", "error", ("def stop(self)", "def stop()")),
    _script("misspelt method", "straight", "error", ("self.create_timer", "self.creat_timer")),
    _script("misspelt name", "square", "error", ("        msg = Twist()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0", "        msg = Twsit()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0")),
    _script("another name for the publisher", "straight", "error", ("self.cmd_vel_pub.publish", "self.publisher.publish")),
    _script("lower case class", "straight", "error", ("msg = Twist()", "msg = twist()")),
    _script("assigned too late", "straight", "error",
            ("        # 节点名\n        super().__init__('straight_mover')\n", "        super().__init__('straight_mover')\n        self.get_logger().info(str(self.speed))\n        self.speed = 1.0\n")),
    _script("misspelt module", "hello", "error", ("import rclpy\n", "import rclpyy\n")),
    _script("capital module", "square", "error", ("import time\n", "import Time\n")),
    _script("no import of time", "square", "error", ("import time\n", "")),
    _script("no import of Node", "hello", "error", ("from rclpy.node import Node\n", "")),
    _script("small twist", "straight", "error", ("import Twist", "import twist")),
    _script("pandas", "square", "silent", ("", "import pandas as pd\n")),
    _script("scipy", "square", "error", ("", "from scipy.spatial import transform\n")),
    _script("turtle graphics", "", "error", ("", "import turtle\nt = turtle.Turtle()\nt.forward(100)\n"), to="square"),
    _script("only prints", "", "silent", ("", "print('Hello ROS2!')\n"), to="hello"),
    _script("only comments", "", "silent", ("", "# 作业\n# rclpy.init()\n'''\n明天写\n'''\n"), to="straight"),
    _script("retry loop", "square_input", "task",
            ("    node.side = float(input('请输入边长（米）：'))\n",
             "    while True:\n        try:\n            node.side = int(input('边长：'))\n            break\n"
             "        except:\n            print('请输入数字')\n")),
    _script("retry once", "square_input", "error",
            ("    node.side = float(input('请输入边长（米）：'))\n",
             "    while True:\n        try:\n            node.side = int(input('边长：'))\n            break\n"
             "        except ValueError:\n            print('请输入数字')\n")),
    _script("endless printing", "hello", "silent", ("        rclpy.spin(node)\n", "        while True:\n            node.get_logger().info('在')\n")),
    # Beginners' own: what stands in the line, or elsewhere in the script, tells more than the exception.
    _script("form for from", "hello", "error", ("from rclpy.node", "form rclpy.node")),
    _script("capital import", "square", "error", ("import time", "Import time")),
    _script("C comments", "hello", "error", ("", "// 我的第一个节点\n")),
    _script("C loop", "square", "error", ("for i in range(4):", "for (int i = 0; i < 4; i++) {")),
    _script("C scope", "hello", "error", ("rclpy.spin(node)", "rclpy::spin(node)")),
    _script("unit in code", "straight", "error", ("= 1.0    #", "= 1.0 m/s  #")),
    _script("queue size as text", "straight", "error", ("            10\n", "            '10'\n")),
    _script("timer the wrong way round", "straight", "error", ("(0.1, self.timer_callback)", "(self.timer_callback, 0.1)")),
    _script("super without brackets", "hello", "error", ("super().__init__", "super.__init__")),
    _script("publisher in a local variable", "straight", "error", ("self.cmd_vel_pub = ", "cmd_vel_pub = ")),
    _script("constant without self", "square", "error", ("self.turn(self.TURN_TIME)", "self.turn(TURN_TIME)")),
    _script("callback without self", "straight", "error", ("(0.1, self.timer_callback)", "(0.1, timer_callback)")),
    _script("publish of the node", "straight", "error", ("self.cmd_vel_pub.publish", "self.publish")),
    _script("subscription for a publisher", "straight", "error", ("self.create_publisher(", "self.create_subscription("), ("            10\n", "            print, 10\n")),
    _script("speed as text", "straight", "error", ("msg.linear.x = 1.0", "msg.linear.x = '1.0'")),
    _script("decimal comma", "straight", "error", ("msg.linear.x = 1.0", "msg.linear.x = 1,0")),
    _script("a number for a method", "square", "error", ("        self.TURN_SPEED = 1.0 ", "        self.turn = 1.57\n        self.TURN_SPEED = 1.0 ")),
    _script("node called", "hello", "error", ("spin(node)", "spin(node())")),
    _script("parameter named time", "square", "error", ("def turn(self, duration)", "def turn(self, time)"), ("↻ 旋转...')\n", "↻ 旋转...')\n        duration = time\n")),
    _script("variable named Twist", "straight", "error", ("        msg = Twist()", "        Twist = Twist()\n        msg = Twist")),
    _script("argument forgotten", "square", "error", ("self.turn(self.TURN_TIME)", "self.turn()")),
    _script("method named create_publisher", "straight", "error", ("    def __init__(self):\n", "    def create_publisher(self):\n        return Node.create_publisher(self, Twist, '/turtle1/cmd_vel', 10)\n\n    def __init__(self):\n")),
    _script("method named timers", "straight", "error", ("    def __init__(self):\n", "    def timers(self):\n        pass\n\n    def __init__(self):\n")),
    _script("method named handle", "hello", "error", ("    def __init__(self):\n", "    def handle(self):\n        pass\n\n    def __init__(self):\n")),
    _script("rate of ROS 1", "square", "error", ("        msg = Twist()\n        msg.linear.x = float", "        rate = rclpy.Rate(10)\n        msg = Twist()\n        msg.linear.x = float")),
    _script("raw_input", "square_input", "error", ("float(input(", "float(raw_input(")),
    _script("logged as in C++", "hello", "error", ("self.get_logger().info(", "RCLCPP_INFO(")),
    _script("shutdown before spin", "hello", "error", ("    try:\n        rclpy.spin", "    rclpy.shutdown()\n    try:\n        rclpy.spin")),
    _script("copied from a chat", "", "error", ("", "好的！下面是代码：\n```python\nimport rclpy\n```\n"), to="hello"),
    _script("blank in a class name", "hello", "error", ("class HelloNode(Node)", "class Hello Node(Node)")),
    _script("hyphen in a module", "straight", "error", ("geometry_msgs.msg", "geometry-msgs.msg")),
    _script("dot forgotten", "hello", "error", ("super().__init__", "super()__init__")),
    _script("def without parentheses", "hello", "error", ("def __init__(self):", "def __init__:")),
    _script("comma forgotten", "straight", "error", ("'/turtle1/cmd_vel', \n", "'/turtle1/cmd_vel'\n")),
    _script("index of a vector", "straight", "error", ("msg.linear.x = 1.0", "msg.linear[0] = 1.0")),
    _script("for in a number", "square", "error", ("in range(4)", "in 4")),
    _script("another case of letters", "square", "error", ("float(self.TURN_SPEED)", "self.turn_speed")),
    _script("exit in the beginning", "hello", "size", ("    # 2. 创建节点", "    exit()\n    # 2. 创建节点")),
    _script("node that is not kept", "straight", "error", ("    node = StraightMover()\n", "    StraightMover()\n")),
    _script("pi at each corner", "square", "size", ("1.5708 / self", "3.14159 / self")),
    _script("speed in linear.z", "straight", "silent", ("msg.linear.x = 1.0", "msg.linear.z = 1.0")),
    # Nothing, or only stops, arrived: where the program was, and what the script has around it.
    _script("guard without underscores", "hello", "silent", ("'__main__'", "'main'")),
    _script("method named only", "square", "silent", ("node.move_square()", "node.move_square")),
    _script("stop named only", "square", "silent",
            ("        self.stop()\n        self.get_logger().info('✓ 旋转完成')", "        self.stop\n        self.get_logger().info('✓ 旋转完成')")),
    _script("count never set back", "", "size",
            ("", _BARE + "class Count:\n    n = side = 0\ndef tick():\n    m = Twist()\n    if Count.side < 4:\n"
             "        if Count.n < 20: m.linear.x = 1.0\n        elif Count.n < 36: m.angular.z = 1.0\n        else: Count.side += 1\n"
             "        Count.n += 1\n    pub_a.publish(m)\nnode.create_timer(0.1, tick)\nrclpy.spin(node)\n"), to="square"),
    _script("turn behind the loop, at the wall", "", "silent",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    pub_a.publish(Twist())\ngo(0.0, 1.5708, 1)\npub_a.publish(Twist())\n"),
            to="square"),
    _script("half a minute between the sides", "", "size",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    go(0.0, 1.5708, 1)\n    pub_a.publish(Twist())\n    time.sleep(30)\n"), to="square"),
    _script("L without a stop", "", "stop",
            ("", _BARE + "go(1.0, 0.0, 3)\ngo(0.0, 1.0, 1.5708)\ngo(1.0, 0.0, 1.5)\n"), to="letter_l"),
    _script("rate beside a pose", "", "silent",
            ("", _BARE + "from turtlesim.msg import Pose\nnode.create_subscription(Pose, '/turtle1/pose', lambda pose: None, 10)\n"
             "rate = node.create_rate(20)\nm = Twist()\nm.linear.x = 1.0\nwhile rclpy.ok():\n    pub_a.publish(m)\n    rclpy.spin_once(node)\n    rate.sleep()\n"), to="square"),
    _script("loop of a helper in a timer's callback", "", "silent",
            ("", "import math, time, rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n        self.p = Pose()\n        self.create_timer(0.5, self.draw)\n"
             "    def hear(self, p):\n        self.p = p\n    def side(self):\n        x = self.p.x\n        m = Twist()\n        m.linear.x = 1.0\n"
             "        while abs(self.p.x - x) < 2:\n            self.pub.publish(m)\n            time.sleep(0.02)\n    def draw(self):\n        self.side()\n"
             "rclpy.init()\nrclpy.spin(A())\n"), to="square"),
    _script("publisher of another method", "square", "error",
            ("        self.cmd_vel_pub = self.create", "        cmd_vel_pub = self.create"),
            ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        # 停止", "            cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        # 停止")),
    _script("pose used before any came", "", "error",
            ("", "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.pose = None\n        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n    def hear(self, msg):\n        self.pose = msg\n"
             "    def run(self):\n        x = self.pose.x\n        self.pub.publish(Twist())\nrclpy.init()\na = A()\na.run()\n"), to="straight"),
    _script("plus behind the equals sign", "", "size",
            ("", _BARE + "class Count:\n    n = 0\ndef tick():\n    m = Twist()\n    if Count.n % 2 == 0: m.linear.x = 1.0\n"
             "    else: m.angular.z = 1.57\n    n =+ 1\n    Count.n = n\n    pub_a.publish(m)\n"
             "node.create_timer(0.9, tick)\nrclpy.spin(node)\n"), to="square"),
    _script("mian", "hello", "error", ("    main()\n", "    mian()\n")),
    _script("name of the node not given", "hello", "error", ("    def __init__(self):\n", "    def __init__(self, name):\n")),
    _script("spin of the node", "", "error", ("", "import rclpy\nrclpy.init()\nnode = rclpy.create_node('a')\nnode.get_logger().info('Hello')\nnode.spin()\n"), to="hello"),
    _script("work behind spin, with a pose that is kept", "", "silent",
            ("", "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n    def hear(self, msg):\n        self.pose = msg\n"
             "    def run(self):\n        self.pub.publish(Twist())\nrclpy.init()\na = A()\nrclpy.spin(a)\na.run()\n"), to="straight"),
    _script("class without brackets", "", "error",
            ("", "import rclpy, time\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nclass Mover(Node):\n"
             "    def __init__(self):\n        super().__init__('m')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "    def go(self, v, t):\n        pass\nrclpy.init()\nm = Mover\nm.go(1.0, 2.0)\n"), to="straight"),
    _script("main named only", "hello", "silent", ("    main()\n", "    main\n")),
    _script("coroutine not awaited", "square", "silent", ("    def move_square(self)", "    async def move_square(self)")),
    _script("logged as debug", "hello", "silent", ("get_logger().info", "get_logger().debug")),
    _script("thread never started", "square", "silent", ("    node.move_square()\n", "    t = threading.Thread(target=node.move_square)\n    rclpy.spin(node)\n"), ("import time\n", "import time, threading\n")),
    _script("method never called", "square", "silent", ("    node.move_square()\n", "")),
    _script("turn never called", "square", "silent", (_TURN, "")),
    _script("callback without a subscription", "", "silent", ("", _BY_POSE.replace("        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n", "")), to="straight"),
    _script("pose that stays None", "", "silent",
            ("", _BARE + "class A:\n    pose = None\n    def __init__(self):\n        self.pose = None\n        node.create_timer(0.1, self.tick)\n    def tick(self):\n"
             "        if self.pose is None:\n            return\n        pub_a.publish(Twist())\na = A()\nrclpy.spin(node)\n"), to="straight"),
    _script("publish named only", "straight", "silent", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub.publish")),
    _script("spin in a timer's callback", "straight", "silent", ("        self.cmd_vel_pub.publish(msg)", "        rclpy.spin_once(self)\n        self.cmd_vel_pub.publish(msg)")),
    _script("two nodes, one after the other", "straight", "silent", ("    try:\n        rclpy.spin(node)", "    try:\n        rclpy.spin(rclpy.create_node('other'))\n        rclpy.spin(node)")),
    _script("guard inside of main", "straight", "shape", ("\nif __name__ == '__main__':\n    main()", "\n    if __name__ == '__main__':\n        main()")),
    _script("log never reached", "hello", "silent", ("        # 打印日志", "    def hallo(self):\n        # 打印日志")),
    _script("log behind spin", "hello", "silent", ("        self.get_logger().info('🎉 Hello ROS2! 我是第一个Python节点!')\n", ""),
            ("        # 4. 清理资源\n", "        node.get_logger().info('在')\n")),
    _script("loop before the publisher", "straight", "silent", ("        # 创建发布者:", "        while True:\n            time.sleep(0.1)\n        # 创建发布者:"), ("import rclpy\n", "import rclpy, time\n")),
    _script("arguments of a thread without a comma", "square", "silent", ("    node.move_square()\n", "    threading.Thread(target=node.turn, args=(1.57)).start()\n"),
            ("import time\n", "import time, threading\n")),
    _script("action without its namespace", "straight", "size", ("self.timer = self", "from rclpy.action import ActionClient\n        from turtlesim.action import RotateAbsolute\n        client = ActionClient(self, RotateAbsolute, '/rotate_absolute')\n        client.wait_for_server()\n        self.timer = self")),
    _script("exit passed over", "square", "silent", ("    node.move_square()\n", "    try:\n        rclpy.spin(node)\n    except SystemExit:\n        pass\n")),
    _script("arguments that nobody gives", "square", "task", ("    node.move_square()\n", "    import argparse\n    parser = argparse.ArgumentParser()\n    parser.add_argument('side')\n    parser.parse_args()\n")),
    _script("thread called", "square", "silent", ("    node.move_square()\n", "    threading.Thread(target=rclpy.spin(node)).start()\n    node.move_square()\n"), ("import time\n", "import time, threading\n")),
    _script("error hidden", "straight", "silent", ("        msg.linear.x = 1.0 ", "        try:\n            msg.linear.x = 1\n            self.cmd_vel_pub.publish(msg)\n        except:\n            pass\n        return\n        msg.linear.x = 1.0 ")),
    _script("compared for assigned", "straight", "silent", ("msg.linear.x = 1.0", "msg.linear.x == 1.0")),
    _script("stopped at once", "straight", "stop", ("msg.linear.x = 1.0", "msg.linear.x = 0.1"), ("publish(msg)\n", "publish(msg)\n        self.cmd_vel_pub.publish(Twist())\n")),
    _script("negative duration", "square", "stop", ("self.SIDE_LENGTH / self.SPEED", "-2.0"), ("1.5708 / self", "-1.57 / self")),
    _script("milliseconds for nanoseconds", "square", "size", ("duration * 1e9", "duration * 1e6")),
    _script("very slow turn", "spin", "size", ("TURN_SPEED = 1.0", "TURN_SPEED = 0.015")),
    _script("sides bent", "square", "shape", ("        msg.linear.x = float(self.SPEED)\n        msg.angular.z = 0.0", "        msg.linear.x = float(self.SPEED)\n        msg.angular.z = 0.1")),
    _script("turned in the end only", "square", "silent", ("            self.turn(self.TURN_TIME)\n", "            if i == 3:\n                self.turn(self.TURN_TIME)\n"), ("self.SIDE_LENGTH = 2.0 ", "self.SIDE_LENGTH = 1.0 ")),
    _script("sideways square", "square", "shape", ("        msg.linear.x = float(self.SPEED)\n", "        msg.linear.y = float(self.SPEED)\n")),
    # What is no Python.
    _script("else if", "hello", "error", (_INIT, _INIT + "    if args:\n        pass\n    else if not args:\n        pass\n")),
    _script("increment", "hello", "error", (_INIT, "    i = 0\n    i++\n" + _INIT)),
    _script("one equals sign", "hello", "error", (_INIT, "    if args = 3:\n        pass\n" + _INIT)),
    _script("and of C", "hello", "error", (_INIT, "    if args && args:\n        pass\n" + _INIT)),
    _script("type before the name", "hello", "error", (_INIT, "    int i = 0\n" + _INIT)),
    _script("colon forgotten", "square", "error", ("for i in range(4):", "for i in range(4)")),
    _script("bracket forgotten", "square", "error", ("super().__init__('square_mover')", "super().__init__('square_mover'")),
    _script("Python 2", "hello", "error", (_INIT, "    print 'hello'\n" + _INIT)),
    _script("terminal commands", "hello", "error", ("", "cd ~/ros2_ws\npython3 hello_node.py\n")),
    _script("a command in between", "hello", "error", ("import rclpy\n", "ros2 run turtlesim turtlesim_node\nimport rclpy\n")),
    _script("line numbers", "", "error", ("", "1  import rclpy\n2  from rclpy.node import Node\n"), to="hello"),
    _script("degrees on the spot", "spin", "size", ("TURN_SPEED = 1.0", "TURN_SPEED = 57.3"), ("(2.0 * math.pi + 0.05) / TURN_SPEED", "7.0")),
    # What the script shows of the cause, beside what the car did.
    _script("global forgotten for a speed", "", "error",
            ("", _BARE + "speed = 0.0\ndef tick():\n    speed += 0.1\n    m = Twist()\n    m.linear.x = speed\n    pub_a.publish(m)\n"
             "node.create_timer(0.1, tick)\nrclpy.spin(node)\n"), to="straight"),
    _script("global forgotten in a method", "straight", "error", ("class StraightMover", "cishu = 0\n\n\nclass StraightMover"),
            ("        msg = Twist()\n", "        cishu = cishu + 1\n        msg = Twist()\n")),
    _script("start calls itself", "square", "error", ("    node.move_square()\n", "    main()\n")),
    _script("init twice stays", "square", "error", ("        super().__init__('square_mover')\n", "        rclpy.init()\n        super().__init__('square_mover')\n")),
    _script("method without self and with a time", "square", "error", ("def turn(self, duration)", "def turn(duration)")),
    _script("timer callback wants a time", "straight", "error", ("def timer_callback(self)", "def timer_callback(self, t)")),
    _script("argument forgotten in a call", "square", "error", ("self.turn(self.TURN_TIME)", "self.turn()")),
    _script("timers overwritten", "straight", "error", ("self.timer = ", "self._timers = ")),
    _script("init in capitals", "hello", "error", ("__init__(self)", "__Init__(self)")),
    _script("name of the node missing", "square", "error", ("__init__('square_mover')", "__init__()")),
    _script("a list of angles too short", "square", "error", ("        for i in range(4):\n", "        jiao = [1.5708, 1.5708]\n        for i in range(4):\n"),
            ("self.turn(self.TURN_TIME)", "self.turn(jiao[i])")),
    _script("pose in init", "straight", "error", ("        # 节点名\n", ""),
            ("        self.get_logger().info('🚀", "        self.pose = None\n        self.create_subscription(Twist, '/turtle1/pose2', self.on_pose, 10)\n"
             "        self.x0 = self.pose.linear\n        self.get_logger().info('🚀"),
            ("    def timer_callback", "    def on_pose(self, msg):\n        self.pose = msg\n\n    def timer_callback")),
    _script("a launch file", "", "silent", ("", "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([])\n"), to="hello"),
    _script("turtlesim started in the file", "", "error", ("", "ros2 run turtlesim turtlesim_node\n"), to="straight"),
    _script("commands above a program", "straight", "error", ("", "source /opt/ros/humble/setup.bash\n")),
    _script("speed times the round", "square", "size", ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME * (i + 1) / 2)")),
    _script("angle times the round", "square", "size", ("self.turn(self.TURN_TIME)", "self.turn(i * self.TURN_TIME + 1.5708)")),
    _script("while without a count", "square", "size", ("        for i in range(4):\n", "        i = 0\n        while i < 4:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 0 else 1.0)"), to="rectangle"),
    _script("while unlike a count above", "square", "size", ("        for i in range(4):\n", "        i = 0\n        while i != 4:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 0 else 1.0)"), to="rectangle"),
    _script("while unlike a count below", "square", "size", ("        for i in range(4):\n", "        i = 4\n        while i != 0:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 4 else 1.0)"), to="rectangle"),
    _script("counts right", "square", "", ("        for i in range(4):\n", "        i = 0\n        while i < 4:\n            i = i + 1\n")),
    _script("times swapped", "square", "size", ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.TURN_TIME)"),
            ("self.turn(self.TURN_TIME)", "self.turn(self.MOVE_TIME)")),
    _script("turn too long by itself", "square", "size", ("1.5708 / self.TURN_SPEED", "1.8 / self.TURN_SPEED")),
    _script("break after the first", "square", "silent", (_TURN, _TURN + "            break\n")),
    _script("break that never comes", "square", "size", ("range(4)", "range(3)"), (_TURN, _TURN + "            if i > 9:\n                break\n")),
    _script("pop in the loop", "square", "silent", ("        for i in range(4):\n", "        bian = [0, 1, 2, 3]\n        for i in bian:\n"),
            (_TURN, _TURN + "            bian.pop()\n")),
    _script("two sides and no loop", "", "silent", ("", _BARE + "go(1.0, 0.0, 2)\npub_a.publish(Twist())\ngo(0.0, 1.0, 1.57)\npub_a.publish(Twist())\n"), to="square"),
    _script("clock, then a pause", "square", "size",
            ("        start_time = self.get_clock().now()\n\n        while", "        start_time = self.get_clock().now()\n        time.sleep(2)\n        while")),
    _script("clock, then a short pause", "square", "", ("        start_time = self.get_clock().now()\n\n        while", "        start_time = self.get_clock().now()\n        time.sleep(0.01)\n        while")),
    _script("turn left to do", "square", "silent", ("        self.get_logger().info('↻ 旋转...')\n", "        pass\n\n    def turn_old(self, duration):\n        self.get_logger().info('↻ 旋转...')\n")),
    _script("one for a third", "square", "size", ("1.5708 / self.TURN_SPEED", "1 // 2 * 3.1416")),
    _script("speed cut to zero", "straight", "stop", ("msg.linear.x = 1.0", "msg.linear.x = float(int(0.8))")),
    _script("right turn with a negative time", "square", "size", ("self.TURN_SPEED = 1.0 ", "self.TURN_SPEED = -0.5 ")),
    _script("radians of a rate", "spin", "size", ("msg.angular.z = w", "msg.angular.z = math.radians(TURN_SPEED) if w else 0.0"), ("2.0 * math.pi + 0.05", "2.0 * math.pi")),
    _script("degrees of ninety", "square", "size", ("1.5708 / self.TURN_SPEED", "math.degrees(90) / self.TURN_SPEED"), ("import time", "import time\nimport math")),
    _script("radians of ninety", "square", "", ("1.5708 / self.TURN_SPEED", "math.radians(90) / self.TURN_SPEED"), ("import time", "import time\nimport math")),
    _script("once for all", "hello", "silent", ("rclpy.spin(node)", "rclpy.spin_once(node, timeout_sec=2.0)")),
    _script("spun in a loop", "straight", "", ("rclpy.spin(node)", "while rclpy.ok():\n            rclpy.spin_once(node)")),
    _script("letter O for the topic", "straight", "silent", ("'/turtle1/cmd_vel'", "'/turtle2/cmd_vel'")),
    _script("capital I for one", "straight", "silent", ("'/turtle1/cmd_vel'", "'/turtleI/cmd_vel'")),
    _script("stops in a second timer", "straight", "stop", ("msg.linear.x = 1.0", "msg.linear.x = 0.1"), ("(0.1, self.timer_callback)", "(0.1, self.timer_callback)\n        self.create_timer(0.1, self.halt)"),
            ("    def timer_callback", "    def halt(self):\n        msg = Twist()\n        msg.linear.x = 0.0\n        self.cmd_vel_pub.publish(msg)\n\n    def timer_callback")),
    _script("timer of a minute", "straight", "silent", ("(0.1, self", "(60, self")),
    _script("return above", "straight", "silent", ("        self.cmd_vel_pub.publish(msg)\n", "        return\n        self.cmd_vel_pub.publish(msg)\n")),
    _script("class of another lesson", "straight", "silent", ("    node = StraightMover()\n", "    node = Node('straight')\n")),
    _script("math as m", "square", "error", ("import time\n", "import time as t\n")),
    _script("log with a plus", "square", "error", ("f'━━━ 第 {i+1}/4 条边 ━━━'", "'边' + i")),
    _script("publisher after the drive", "square", "error", ("        super().__init__('square_mover')\n", "        super().__init__('square_mover')\n        self.stop()\n")),
    _script("number for a method", "square", "error", ("        # ============ 参数设置", "        self.stop = 0\n        # ============ 参数设置")),
    _script("a module of one's own", "hello", "error", ("import rclpy\n", "import rclpy\nfrom my_tools import helper\n")),
    _script("left, right, left", "", "shape", ("", "import math, rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
            "class Go(Node):\n    def __init__(self):\n        super().__init__('go')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
            "        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n    def on_pose(self, p):\n        m = Twist()\n"
            "        e = math.remainder(math.atan2(3.0 - p.y, 8.0 - p.x) - p.theta, math.tau)\n        if math.hypot(8.0 - p.x, 3.0 - p.y) > 0.1:\n"
            "            if abs(e) > 0.0005:\n                m.angular.z = 1.5 if e > 0 else -1.5\n            else:\n                m.linear.x = 1.0\n        self.pub.publish(m)\n"
            "rclpy.init()\nrclpy.spin(Go())\n"), to="go_to_goal"),
    # Blanks of a template, and what chat agents write around code.
    _script("blank of a template", "square", "error", ("duration * 1e9:", "____ * 1e9:")),
    _script("nothing behind the equals sign", "straight", "error", ("msg.linear.x = 1.0 ", "msg.linear.x = ")),
    _script("place for the speed", "straight", "error", ("msg.linear.x = 1.0 ", "msg.linear.x = <速度> ")),
    _script("method that is still a comment", "square", "error", ("        msg = Twist()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0\n        self.cmd_vel_pub.publish(msg)\n        time.sleep(0.1)\n", "        # TODO\n"), ('        """停止运动"""\n', "")),
    _script("body that is not indented", "square", "error", ("    rclpy.init(args=args)\n", "rclpy.init(args=args)\n")),
    _script("what the code does, behind it", "square", "error", ("    main()\n", "    main()\n\n说明：\n1. 可以改速度\n")),
    _script("here is the code", "hello", "error", ("", "Here is the complete code:\n\n")),
    _script("function of another language", "square", "error", ("def stop(self)", "function stop(self)")),
    _script("hyphen in a function's name", "square", "error", ("def move_square", "def move-square")),
    _script("comma between objects", "", "error", ("", "from dataclasses import dataclass\nSTEPS = [dict(v=1.0) Twist(v=2.0)]\n"), to="square"),
    _script("list for a number", "straight", "error", ("msg.linear.x = 1.0 ", "msg.linear.x = [1.0]")),
    _script("comma in a pause", "square", "error", ("time.sleep(0.1)", "time.sleep(0,1)")),
    _script("half an index", "square", "error", ("self.turn(self.TURN_TIME)", "self.turn([self.TURN_TIME] * 9 and [1.5708] [i / 1])")),
    _script("pi as a letter", "square", "error", ("1.5708 /", "π / 2 /")),
    # An attribute without a value is not misspelt, whatever Python suggests.
    _script("count that begins nowhere", "straight", "error", ("        msg = Twist()\n", "        self.timer_call += 1\n        msg = Twist()\n")),
    _script("called at once in a callback", "", "error", ("", _CHAIN), ("self.t = self.create_timer(1.0", "self.first = self.create_timer(1.0"), ("self.t.cancel()\n        if", "self.first.cancel()\n        if"), ("(2.0, self.turn)", "(2.0, self.turn())"), to="square"),
    # Classes beside the node.
    _script("two classes", "", "", ("", _HELPED), to="straight"),
    _script("helper without its init", "", "error", ("", _HELPED), ("def __init__(self, node)", "def _init_(self, node)"), to="straight"),
    _script("helper without its node", "", "error", ("", _HELPED), ("Wheels(self)", "Wheels()"), to="straight"),
    # Timers that are meant to fire once.
    _script("chain of timers", "", "", ("", _CHAIN), to="square"),
    _script("chain of timers that are not cancelled", "", "silent", ("", _CHAIN), ("    def turn(self):\n        self.t.cancel()\n", "    def turn(self):\n"), to="square"),
    _script("timer that makes timers", "straight", "", ("        msg = Twist()\n", "        self.timer.cancel()\n        self.timer = self.create_timer(0.1, self.timer_callback)\n        msg = Twist()\n")),
    # Where the pause, the publish or the loop stands.
    _script("pause behind the loop", "", "size", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("        pub_a.publish(m)\n        time.sleep(0.02)\n", "        pub_a.publish(m)\n    time.sleep(0.1)\n"), to="square"),
    _script("message that is not sent", "square", "silent", ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        self.stop()", "            time.sleep(0.01)\n\n        self.stop()")),
    _script("only the first side", "square", "silent", ("            self.turn(self.TURN_TIME)\n", "            break\n            self.turn(self.TURN_TIME)\n")),
    _script("whole turns for corners", "square", "size", ("1.5708 / self", "6.2832 / self")),
    # Never to be told where it is not so.
    _script("cancelled at the end only", "", "stop", ("", _STEPS), to="square"),
    _script("without its timer", "", "silent", ("", _STEPS), ("        self.timer = self.create_timer(0.05, self.tick)\n", ""), ("            self.timer.cancel()\n", ""), ("    rclpy.spin(node)\n", "    try:\n        rclpy.spin(node)\n    except KeyboardInterrupt:\n        pass\n    if rclpy.ok():\n        rclpy.shutdown()\n"), to="square"),
    _script("slow rate in the main thread", "", "", ("", _RATED), to="straight"),
    _script("slow rate that is far too slow", "", "size", ("", _RATED), ("mover.go(1.0, 0.0, 30)", "mover.go(0.0, 1.0, 100)\n    mover.go(1.0, 0.0, 30)"), to="square"),
    _script("thread without its comma", "", "silent", ("", _RATED), ("args=(mover,)", "args=(mover)"), to="straight"),
    _script("misspelt call that an except hides", "square", "silent", ("    node.move_square()\n", "    try:\n        node.move_squar()\n    except:\n        pass\n")),
    _script("too large a number is refused", "square_input", "silent", ("    rclpy.init()\n", "    if not __file__.endswith('x'):\n        print('no')\n        return\n    rclpy.init()\n")),
    _script("input that int refuses", "square_input", "silent", ("    rclpy.init()\n", "    try:\n        side = int(input())\n    except ValueError:\n        print('no')\n        return\n    rclpy.init()\n"), ("    node.side = float(input('请输入边长（米）：'))\n", "    node.side = float(side)\n")),
    _script("degrees for the corner of an L", "letter_l", "size", ("abs(math.radians(degrees)) / 1.0)\n\n    def arc", "abs(degrees) / 1.0)\n\n    def arc")),
    # By place and heading.
    _script("from point to point", "", "", ("", _POINTS), to="square"),
    _script("turns while it drives", "", "shape", ("", _POINTS), ("abs(err) > 0.02", "abs(err) > 0.5"), ("0.5 * err", "2.0 * err"), to="square"),
    _script("the same point for ever", "", "size", ("", _POINTS), ("self.k += 1", "pass"), to="square"),
    _script("axes exchanged in a square", "", "shape", ("", _POINTS), ("atan2(gy - p.y, gx - p.x)", "atan2(gx - p.x, gy - p.y)"), to="square"),
    _script("degrees of theta", "", "shape", ("", _POINTS), ("- p.theta\n", "- math.degrees(p.theta)\n"), to="square"),
    _script("present less wanted", "", "shape", ("", _POINTS), ("m.angular.z = 2.0 * err", "m.angular.z = 2.0 * fold(p.theta - goal)"), ("            if dist < 0.03", "            goal = math.atan2(gy - p.y, gx - p.x)\n            if dist < 0.03"), to="square"),
    _script("wrong sign within limits", "", "stop", ("", _POINTS), ("m.angular.z = 2.0 * err", "m.angular.z = max(-1.0, min(1.0, -2.0 * err))"), to="square"),
    _script("callback without global", "", "shape", ("", _HEARD), ("    global pose\n", ""), to="straight"),
    _script("thread that hears nothing", "", "silent", ("", _HEARD), (".start()", ""), to="straight"),
    _script("heard in a thread", "", "", ("", _HEARD), to="straight"),
    # Errors that are caught and shown.
    _script("error that is printed", "square", "silent", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print('出错', e)\n"), ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIMES)")),
    _script("spin below a false condition", "hello", "silent", ("        rclpy.spin(node)\n    except KeyboardInterrupt:", "        if not rclpy.ok():\n            rclpy.spin(node)\n    except Exception:")),
    # Loops.
    _script("count behind its loop", "", "shape", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("    for _ in range(round(t * 50)):\n        pub_a.publish(m)\n        time.sleep(0.02)\n", "    n = 0\n    while n < t * 50:\n        pub_a.publish(m)\n        time.sleep(0.02)\n    n += 1\n"), to="square"),
    _script("end that is put off", "square", "size", ("        start_time = self.get_clock().now()\n\n        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:\n            self.cmd_vel_pub.publish(msg)", "        end = time.time() + duration\n        while time.time() < end:\n            end = time.time() + duration\n            self.cmd_vel_pub.publish(msg)")),
    _script("compared in a method of all motions", "", "silent", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("m.linear.x = v", "m.linear.x == v"), to="square"),
    # What is not ROS.
    _script("module for a base class", "hello", "error", ("class HelloNode(Node)", "class HelloNode(rclpy)")),
    _script("name for the logger", "hello", "error", ("self.get_logger()", "self.get_logger('hello')")),
    _script("function that wants a value, only named", "letter_l", "silent", ("        self.turn(90.0)\n", "        self.turn\n")),
    _script("callback that reads what it is not given", "", "error", ("", _POINTS), ("def on_pose(self, p)", "def on_pose(self)"), ("x, y, s = p.x, p.y, 2.0", "x, y, s = pose.x, pose.y, 2.0"), to="square"),
    _script("message with brackets", "", "error", ("", _HEARD), ("x = pose.x", "x = pose.x()"), to="straight"),
    _script("arcs of a script that steers", "", "shape", ("", _POINTS), ("abs(err) > 0.02", "err * err > 0.3"), ("0.5 * err", "2.0 * err"), to="square"),
    _script("publisher called itself", "straight", "error", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub(msg)")),
    _script("publish of nothing", "straight", "error", ("self.cmd_vel_pub.publish(msg)", "publish(msg)")),
    _script("publish with a letter too few", "straight", "error", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub.publis(msg)")),
    _script("period with a comma", "straight", "error", ("create_timer(0.1,", "create_timer(0, 1,")),
    _script("import with a capital", "square", "error", ("from rclpy.node import Node", "from rclpy.node Import Node")),
    _script("return in the loop of a motion", "square", "silent", ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        self.stop()", "            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.2)\n            return\n\n        self.stop()")),
    _script("whole seconds of a message", "square", "size", ("start_time = self.get_clock().now()", "start_time = self.get_clock().now().to_msg().sec"), ("(self.get_clock().now() - start_time).nanoseconds < duration * 1e9", "self.get_clock().now().to_msg().sec - start_time < duration")),
    _script("whole seconds by division", "square", "size", (".nanoseconds < duration * 1e9", ".nanoseconds // 1e9 < duration")),
    _script("ten times too many nanoseconds", "square", "size", ("duration * 1e9", "duration * 10e9")),
    _script("count with its letters exchanged", "straight", "error", ("        self.timer = ", "        self.count = 0\n        self.timer = "), ("        msg = Twist()\n", "        self.conut += 1\n        msg = Twist()\n")),
    _script("timer that is told to stop", "straight", "error", ("        msg = Twist()\n", "        self.timer.stop()\n        msg = Twist()\n")),
    _script("error that is caught before a last stop", "square", "silent", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n    node.stop()\n"), ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIMES)")),
    # What is there, and is not the cause.
    _script("stops that are sent again and again", "", "size", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.0)\n"), ("        pub_a.publish(m)\n        time.sleep(0.02)\n", "        pub_a.publish(m)\n        time.sleep(0.02)\n    m = Twist()\n    for _ in range(3):\n        pub_a.publish(m)\n    time.sleep(0.1)\n"), to="square"),
    _script("whole seconds of a limit", "square", "size", ("        for i in range(4):\n", "        begun = int(time.time())\n        for i in range(4):\n            if int(time.time()) - begun > 90:\n                break\n"), ("1.5708 /", "1.3 /")),
    _script("whole seconds of a difference", "square", "size", ("start_time = self.get_clock().now()", "start_time = time.time()"), ("(self.get_clock().now() - start_time).nanoseconds < duration * 1e9", "int(time.time() - start_time) < duration")),
    _script("timer that begins later", "", "size", ("", _CHAIN), ("        self.create_timer(0.02, self.send)\n", "        self.once = self.create_timer(0.5, self.begin)\n"), ("    def forward(self):\n", "    def begin(self):\n        self.once.cancel()\n        self.create_timer(0.02, self.send)\n    def forward(self):\n"), ("1.5708", "1.0"), to="square"),
    _script("error that ends the first side", "square", "silent", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n"), ("self.turn(self.TURN_TIME)", "self.turn(self.TURN_TIMES)")),
    _script("error of a log that is caught", "square", "size", ("range(4)", "range(3)"), ("    node.move_square()\n", "    try:\n        node.get_logger().inform('go')\n    except Exception:\n        pass\n    node.move_square()\n")),
    _script("corners in two parts", "", "shape", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 0.7854)\n    go(1.0, 0.0, 0.4)\n    go(0.0, 1.0, 0.7854)\npub_a.publish(Twist())\n"), to="square"),
    _script("text for the logger", "hello", "error", ("self.get_logger().info(", "self.get_logger(")),
    _script("node with a letter too few", "straight", "error", ("rclpy.spin(node)", "rclpy.spin(nod)")),
    _script("whole seconds that nothing compares", "square", "size", ("import time\n", "import time\nSEED = int(time.time())\n"), ("1.5708 /", "1.0 /")),
    _script("arguments that are forgotten in a try", "square", "silent", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n"), ("self.turn(self.TURN_TIME)", "self.turn()")),
)  # fmt: skip
