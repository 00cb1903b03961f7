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
    """One script. `cause` is the code that comes first, empty where no hint may come; `words` stand in both texts."""

    name: str
    base: str
    cause: str
    edits: tuple[Edit, ...]
    words: tuple[str, ...] = ()
    assignment: str = ""

    @property
    def source(self) -> str:
        text = BASES[self.base].read_text(encoding="utf-8") if self.base else ""
        for old, new in self.edits:
            assert old in text, (self.name, old)
            text = text.replace(old, new) if old else new + text
        return text


def _script(name: str, base: str, cause: str, *edits: Edit, words: str = "", to: str = "") -> Script:
    return Script(name, base, cause, edits, tuple(words.split("|")) if words else (), to or base)


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
    _script("body not in the executor", "", "node_never_published", ("", _BRAIN), ("ex.add_node(body)", "pass"), words="/body", to="straight"),
    # What nobody sends.
    _script("pose with a capital", "", "topic_nearly", ("", _BY_POSE), ("/turtle1/pose", "/turtle1/Pose"), words="/turtle1/Pose|/turtle1/pose", to="straight"),
    _script("pose without the turtle", "", "topic_nearly", ("", _BY_POSE), ("/turtle1/pose", "pose"), words="/turtle1/pose", to="straight"),
    _script("time of a simulation", "", "sim_time", ("", _BRAIN), ("super().__init__('brain')", "super().__init__('brain', parameter_overrides=[rclpy.parameter.Parameter('use_sim_time', value=True)])"), words="/brain|use_sim_time", to="straight"),
    _script("topic of nobody", "", "topic_nowhere", ("", _BY_POSE), ("/turtle1/pose", "/position"), words="/position|/turtle1/pose", to="straight"),
    _script("service misspelt", "", "service_nearly", ("", _BY_POSE), ("'/turtle1/set_pen", "'/turtle1/setpen"), words="/turtle1/setpen|/turtle1/set_pen", to="straight"),
    _script("service of nobody", "", "service_nowhere", ("", _BY_POSE), ("'/turtle1/set_pen", "'/battery"), words="/battery", to="straight"),
    _script("client of another type", "", "client_type", ("", _BY_POSE), ("(SetPen,", "(Spawn,"), words="turtlesim/srv/SetPen", to="straight"),
    _script("spins in a callback", "", "spin_in_callback", ("", _BY_POSE), ("        msg = Twist()", "        rclpy.spin_until_future_complete(self, future)\n        msg = Twist()"), words="spin_until_future_complete", to="straight"),
    # The order of causes.
    _script("turn behind the loop", "square", "turns_behind_loop", (_TURN, "        " + _TURN.strip() + "\n"), words="90°"),
    _script("turn commented out", "square", "never_called", (_TURN, "            # self.turn(self.TURN_TIME)\n"), words="turn()"),
    _script("turn rate zero", "square", "no_turns", ("msg.angular.z = float(self.TURN_SPEED)", "msg.angular.z = 0.0"),
            ("range(4)", "range(2)")),
    _script("turning time zero", "square", "no_turns", ("1.5708 / self.TURN_SPEED", "1.5708 * 0")),
    _script("turn returns at once", "square", "no_turns", ("        self.get_logger().info('↻ 旋转...')\n", "        return\n")),
    _script("long straight", "straight", "no_turns", to="square"),
    _script("curved", "straight", "curved", ("msg.angular.z = 0.0", "msg.angular.z = 0.5"), words="angular.z"),
    _script("curved to the right", "straight", "curved", ("msg.angular.z = 0.0", "msg.angular.z = -1.0"), words="angular.z"),
    _script("backward", "straight", "drove_backward", ("msg.linear.x = 1.0", "msg.linear.x = -1.0"), words="linear.x"),
    _script("sides too long", "square", "wall_hit", ("self.SIDE_LENGTH = 2.0 ", "self.SIDE_LENGTH = 8.0 ")),
    _script("no stop, then spin", "", "no_final_stop",
            ("", _BARE + "go(1.0, 0.0, 2)\nfor _ in range(3):\n    go(0.0, 1.5708, 1)\n    go(1.0, 0.0, 2)\nrclpy.spin(node)\n"),
            words="pub_a.publish(Twist())", to="square"),
    _script("no stop, then over", "", "no_final_stop",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    go(0.0, 1.5708, 1)\n"),
            words="pub_a.publish(Twist())", to="square"),
    _script("message reused", "", "kept_driving",
            ("", _BARE + "for _ in range(4):\n    go(0.8, 0.0, 2)\n    go(0.8, 1.5708, 1)\npub_a.publish(Twist())\n"),
            words="linear.x|0.8", to="square"),
    _script("published once each", "", "published_once",
            ("", _BARE + "for _ in range(4):\n    m = Twist()\n    m.linear.x = 1.0\n    pub_a.publish(m)\n    time.sleep(2)\n"
             "    m = Twist()\n    m.angular.z = 1.0\n    pub_a.publish(m)\n    time.sleep(1.57)\n"), to="square"),
    _script("too slow", "square", "too_slow", ("self.SPEED = 1.0 ", "self.SPEED = 0.1 ")),
    _script("still on the first side", "square", "too_slow", ("self.SPEED = 1.0 ", "self.SPEED = 0.024 ")),
    _script("degrees", "square", "degrees_as_radians", ("float(self.TURN_SPEED)", "90.0")),
    _script("spin first", "square", "behind_spin", ("    node.move_square()\n", "    rclpy.spin(node)\n    node.move_square()\n"), words="spin"),
    _script("executor spins first", "square", "behind_spin",
            ("    node.move_square()\n",
             "    ex = rclpy.executors.SingleThreadedExecutor()\n    ex.add_node(node)\n    ex.spin()\n    node.move_square()\n"),
            ("import time\n", "import time\nimport rclpy.executors\n")),
    _script("milliseconds", "square", "sleeps_too_long", ("    time.sleep(1)\n", "    time.sleep(1000)\n"), words="1000 s"),
    _script("milliseconds in the loop", "square", "sleeps_too_long", ("time.sleep(0.01)", "time.sleep(100)")),
    _script("callback without publish", "straight", "no_publish", ("        self.cmd_vel_pub.publish(msg)\n", "")),
    # What Python says, in the student's language.
    _script("init twice", "square", "init_twice", (_INIT, _INIT + _INIT)),
    _script("init in the node", "straight", "init_twice", ("        # 节点名\n", "        rclpy.init()\n")),
    _script("a string published", "straight", "wrong_message", ("publish(msg)", "publish('go')"), words="Twist|str"),
    _script("a vector published", "square", "wrong_message", ("        self.cmd_vel_pub.publish(msg)\n        time", "        self.cmd_vel_pub.publish(msg.linear)\n        time"), words="Vector3"),
    _script("a number published", "straight", "wrong_message", ("publish(msg)", "publish(1.0)"), words="float"),
    _script("no base class", "straight", "no_base_class", ("StraightMover(Node)", "StraightMover")),
    _script("no base class, no super", "square", "no_base_class", ("SquareMover(Node)", "SquareMover()"), ("        super().__init__('square_mover')\n", "")),
    _script("int of a decimal", "square_input", "int_of_decimal", ("float(input", "int(input"), words="float("),
    _script("unit read along", "square_input", "not_a_number", ("float(input('请输入边长（米）：'))", "float(input() + 'm')")),
    _script("unbound", "square", "assigned_later", ("        for i in range(4):\n", "        n = n + 1\n        for i in range(4):\n"), words="n"),
    _script("shutdown early", "square", "shutdown_early", ("    node.move_square()\n", "    rclpy.shutdown()\n    node.move_square()\n"), words="shutdown"),
    _script("destroyed early", "square", "destroyed_early", ("    node.move_square()\n", "    node.destroy_node()\n    node.move_square()\n")),
    _script("method outside", "square", "method_outside", ("    def move_square(self)", "def move_square(self)")),
    _script("self forgotten", "square", "missing_self", ("self.move_straight(self", "move_straight(self"), words="self.move_straight("),
    _script("self no parameter", "square", "lacks_self", ("def stop(self)", "def stop()")),
    _script("misspelt method", "straight", "misspelt", ("self.create_timer", "self.creat_timer"), words="create_timer"),
    _script("misspelt name", "square", "misspelt", ("        msg = Twist()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0", "        msg = Twsit()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0"), words="'Twist'"),
    _script("another name for the publisher", "straight", "misspelt", ("self.cmd_vel_pub.publish", "self.publisher.publish")),
    _script("lower case class", "straight", "misspelt", ("msg = Twist()", "msg = twist()"), words="'Twist'"),
    _script("assigned too late", "straight", "not_yet_assigned",
            ("        # 节点名\n        super().__init__('straight_mover')\n", "        super().__init__('straight_mover')\n        self.get_logger().info(str(self.speed))\n        self.speed = 1.0\n"),
            words="self.speed"),
    _script("misspelt module", "hello", "misspelt", ("import rclpy\n", "import rclpyy\n"), words="rclpy"),
    _script("capital module", "square", "misspelt", ("import time\n", "import Time\n"), words="time"),
    _script("no import of time", "square", "missing_import", ("import time\n", ""), words="import time"),
    _script("no import of Node", "hello", "missing_import", ("from rclpy.node import Node\n", ""), words="from rclpy.node import Node"),
    _script("small twist", "straight", "import_statement", ("import Twist", "import twist"), words="from geometry_msgs.msg import Twist"),
    _script("pandas", "square", "library_not_here", ("", "import pandas as pd\n"), words="pandas"),
    _script("scipy", "square", "library_not_here", ("", "from scipy.spatial import transform\n"), words="scipy"),
    _script("turtle graphics", "", "turtle_graphics", ("", "import turtle\nt = turtle.Turtle()\nt.forward(100)\n"), words="turtlesim", to="square"),
    _script("only prints", "", "only_printed", ("", "print('Hello ROS2!')\n"), words="rclpy.init()", to="hello"),
    _script("only comments", "", "no_code", ("", "# 作业\n# rclpy.init()\n'''\n明天写\n'''\n"), to="straight"),
    _script("retry loop", "square_input", "asks_again",
            ("    node.side = float(input('请输入边长（米）：'))\n",
             "    while True:\n        try:\n            node.side = int(input('边长：'))\n            break\n"
             "        except:\n            print('请输入数字')\n"), words="float(input())"),
    _script("retry once", "square_input", "int_asks_again",
            ("    node.side = float(input('请输入边长（米）：'))\n",
             "    while True:\n        try:\n            node.side = int(input('边长：'))\n            break\n"
             "        except ValueError:\n            print('请输入数字')\n"), words="float(input())"),
    _script("endless printing", "hello", "output_limit", ("        rclpy.spin(node)\n", "        while True:\n            node.get_logger().info('在')\n"), words="256 KiB"),
    # Beginners' own: what stands in the line, or elsewhere in the script, tells more than the exception.
    _script("form for from", "hello", "misspelt_keyword", ("from rclpy.node", "form rclpy.node"), words="form|from"),
    _script("capital import", "square", "misspelt_keyword", ("import time", "Import time"), words="import"),
    _script("C comments", "hello", "c_syntax", ("", "// 我的第一个节点\n"), words="#"),
    _script("C loop", "square", "c_syntax", ("for i in range(4):", "for (int i = 0; i < 4; i++) {"), words="range(4)"),
    _script("C scope", "hello", "c_syntax", ("rclpy.spin(node)", "rclpy::spin(node)"), words="rclpy.spin(node)"),
    _script("unit in code", "straight", "unit_in_code", ("= 1.0    #", "= 1.0 m/s  #"), words="m/s"),
    _script("queue size as text", "straight", "qos_number", ("            10\n", "            '10'\n"), words="10"),
    _script("timer the wrong way round", "straight", "timer_order", ("(0.1, self.timer_callback)", "(self.timer_callback, 0.1)"),
            words="create_timer(0.1"),
    _script("super without brackets", "hello", "super_brackets", ("super().__init__", "super.__init__"), words="super()"),
    _script("publisher in a local variable", "straight", "local_only", ("self.cmd_vel_pub = ", "cmd_vel_pub = "), words="self.cmd_vel_pub"),
    _script("constant without self", "square", "missing_self_value", ("self.turn(self.TURN_TIME)", "self.turn(TURN_TIME)"), words="self.TURN_TIME"),
    _script("callback without self", "straight", "missing_self", ("(0.1, self.timer_callback)", "(0.1, timer_callback)"), words="self.timer_callback"),
    _script("publish of the node", "straight", "no_publisher_object", ("self.cmd_vel_pub.publish", "self.publish"), words="self.cmd_vel_pub.publish(msg)"),
    _script("subscription for a publisher", "straight", "no_publisher_object", ("self.create_publisher(", "self.create_subscription("), ("            10\n", "            print, 10\n")),
    _script("speed as text", "straight", "text_in_float", ("msg.linear.x = 1.0", "msg.linear.x = '1.0'")),
    _script("decimal comma", "straight", "comma_in_float", ("msg.linear.x = 1.0", "msg.linear.x = 1,0"), words="1.0"),
    _script("a number for a method", "square", "method_overwritten", ("        self.TURN_SPEED = 1.0 ", "        self.turn = 1.57\n        self.TURN_SPEED = 1.0 ")),
    _script("node called", "hello", "not_callable", ("spin(node)", "spin(node())"), words="rclpy.spin(node)"),
    _script("parameter named time", "square", "hidden_module", ("def turn(self, duration)", "def turn(self, time)"), ("↻ 旋转...')\n", "↻ 旋转...')\n        duration = time\n"), words="time"),
    _script("variable named Twist", "straight", "name_hides_class", ("        msg = Twist()", "        Twist = Twist()\n        msg = Twist"), words="msg = Twist()"),
    _script("argument forgotten", "square", "call_mismatch", ("self.turn(self.TURN_TIME)", "self.turn()"), words="turn"),
    _script("method named create_publisher", "straight", "name_taken", ("    def __init__(self):\n", "    def create_publisher(self):\n        return Node.create_publisher(self, Twist, '/turtle1/cmd_vel', 10)\n\n    def __init__(self):\n"), words="create_publisher"),
    _script("method named timers", "straight", "name_taken", ("    def __init__(self):\n", "    def timers(self):\n        pass\n\n    def __init__(self):\n"), words="timers"),
    _script("method named handle", "hello", "name_taken", ("    def __init__(self):\n", "    def handle(self):\n        pass\n\n    def __init__(self):\n"), words="handle"),
    _script("rate of ROS 1", "square", "rate_of_ros_1", ("        msg = Twist()\n        msg.linear.x = float", "        rate = rclpy.Rate(10)\n        msg = Twist()\n        msg.linear.x = float"), words="rclpy.Rate"),
    _script("raw_input", "square_input", "other_language", ("float(input(", "float(raw_input("), words="input()"),
    _script("logged as in C++", "hello", "other_language", ("self.get_logger().info(", "RCLCPP_INFO("), words="get_logger().info"),
    _script("shutdown before spin", "hello", "shutdown_twice", ("    try:\n        rclpy.spin", "    rclpy.shutdown()\n    try:\n        rclpy.spin"), words="shutdown"),
    _script("copied from a chat", "", "pasted_mark", ("", "好的！下面是代码：\n```python\nimport rclpy\n```\n"), to="hello"),
    _script("blank in a class name", "hello", "blank_in_name", ("class HelloNode(Node)", "class Hello Node(Node)")),
    _script("hyphen in a module", "straight", "hyphen_in_module", ("geometry_msgs.msg", "geometry-msgs.msg"), words="geometry_msgs.msg"),
    _script("dot forgotten", "hello", "missing_dot", ("super().__init__", "super()__init__"), words="super().__init__"),
    _script("def without parentheses", "hello", "def_parentheses", ("def __init__(self):", "def __init__:")),
    _script("comma forgotten", "straight", "missing_comma", ("'/turtle1/cmd_vel', \n", "'/turtle1/cmd_vel'\n")),
    _script("index of a vector", "straight", "vector_index", ("msg.linear.x = 1.0", "msg.linear[0] = 1.0"), words="msg.linear.x"),
    _script("for in a number", "square", "not_iterable", ("in range(4)", "in 4"), words="range(4)"),
    _script("another case of letters", "square", "misspelt", ("float(self.TURN_SPEED)", "self.turn_speed"), words="TURN_SPEED"),
    _script("exit in the beginning", "hello", "exited_early", ("    # 2. 创建节点", "    exit()\n    # 2. 创建节点"), words="exit()"),
    _script("node that is not kept", "straight", "node_not_made", ("    node = StraightMover()\n", "    StraightMover()\n"), words="node = StraightMover()"),
    _script("pi at each corner", "square", "turned_back", ("1.5708 / self", "3.14159 / self"), words="90°"),
    _script("speed in linear.z", "straight", "other_axis", ("msg.linear.x = 1.0", "msg.linear.z = 1.0"), words="linear.z|linear.x"),
    # Nothing, or only stops, arrived: where the program was, and what the script has around it.
    _script("guard without underscores", "hello", "main_guard", ("'__main__'", "'main'"), words="'main'"),
    _script("method named only", "square", "not_called", ("node.move_square()", "node.move_square"), words="move_square()"),
    _script("stop named only", "square", "not_called",
            ("        self.stop()\n        self.get_logger().info('✓ 旋转完成')", "        self.stop\n        self.get_logger().info('✓ 旋转完成')"),
            words="self.stop()"),
    _script("count never set back", "", "sides_missing",
            ("", _BARE + "class Count:\n    n = side = 0\ndef tick():\n    m = Twist()\n    if Count.side < 4:\n"
             "        if Count.n < 20: m.linear.x = 1.0\n        elif Count.n < 36: m.angular.z = 1.0\n        else: Count.side += 1\n"
             "        Count.n += 1\n    pub_a.publish(m)\nnode.create_timer(0.1, tick)\nrclpy.spin(node)\n"), to="square"),
    _script("turn behind the loop, at the wall", "", "turns_behind_loop",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    pub_a.publish(Twist())\ngo(0.0, 1.5708, 1)\npub_a.publish(Twist())\n"),
            to="square"),
    _script("half a minute between the sides", "", "too_slow",
            ("", _BARE + "for _ in range(4):\n    go(1.0, 0.0, 2)\n    go(0.0, 1.5708, 1)\n    pub_a.publish(Twist())\n    time.sleep(30)\n"), to="square"),
    _script("L without a stop", "", "no_final_stop",
            ("", _BARE + "go(1.0, 0.0, 3)\ngo(0.0, 1.0, 1.5708)\ngo(1.0, 0.0, 1.5)\n"), words="pub_a.publish(Twist())", to="letter_l"),
    _script("rate beside a pose", "", "rate_without_spin",
            ("", _BARE + "from turtlesim.msg import Pose\nnode.create_subscription(Pose, '/turtle1/pose', lambda pose: None, 10)\n"
             "rate = node.create_rate(20)\nm = Twist()\nm.linear.x = 1.0\nwhile rclpy.ok():\n    pub_a.publish(m)\n    rclpy.spin_once(node)\n    rate.sleep()\n"),
            words="rate.sleep()", to="square"),
    _script("loop of a helper in a timer's callback", "", "loop_in_callback",
            ("", "import math, time, rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n        self.p = Pose()\n        self.create_timer(0.5, self.draw)\n"
             "    def hear(self, p):\n        self.p = p\n    def side(self):\n        x = self.p.x\n        m = Twist()\n        m.linear.x = 1.0\n"
             "        while abs(self.p.x - x) < 2:\n            self.pub.publish(m)\n            time.sleep(0.02)\n    def draw(self):\n        self.side()\n"
             "rclpy.init()\nrclpy.spin(A())\n"), to="square"),
    _script("publisher of another method", "square", "local_of_method",
            ("        self.cmd_vel_pub = self.create", "        cmd_vel_pub = self.create"),
            ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        # 停止", "            cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        # 停止"),
            words="self.cmd_vel_pub"),
    _script("pose used before any came", "", "none_before_spin",
            ("", "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.pose = None\n        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n    def hear(self, msg):\n        self.pose = msg\n"
             "    def run(self):\n        x = self.pose.x\n        self.pub.publish(Twist())\nrclpy.init()\na = A()\na.run()\n"),
            words="self.pose is None", to="straight"),
    _script("plus behind the equals sign", "", "endless_turn",
            ("", _BARE + "class Count:\n    n = 0\ndef tick():\n    m = Twist()\n    if Count.n % 2 == 0: m.linear.x = 1.0\n"
             "    else: m.angular.z = 1.57\n    n =+ 1\n    Count.n = n\n    pub_a.publish(m)\n"
             "node.create_timer(0.9, tick)\nrclpy.spin(node)\n"), to="square"),
    _script("mian", "hello", "misspelt", ("    main()\n", "    mian()\n"), words="main"),
    _script("name of the node not given", "hello", "init_mismatch", ("    def __init__(self):\n", "    def __init__(self, name):\n")),
    _script("spin of the node", "", "spin_of_rclpy", ("", "import rclpy\nrclpy.init()\nnode = rclpy.create_node('a')\nnode.get_logger().info('Hello')\nnode.spin()\n"),
            words="rclpy.spin(node)", to="hello"),
    _script("work behind spin, with a pose that is kept", "", "behind_spin",
            ("", "import rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
             "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "        self.create_subscription(Pose, '/turtle1/pose', self.hear, 10)\n    def hear(self, msg):\n        self.pose = msg\n"
             "    def run(self):\n        self.pub.publish(Twist())\nrclpy.init()\na = A()\nrclpy.spin(a)\na.run()\n"), to="straight"),
    _script("class without brackets", "", "class_for_object",
            ("", "import rclpy, time\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nclass Mover(Node):\n"
             "    def __init__(self):\n        super().__init__('m')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
             "    def go(self, v, t):\n        pass\nrclpy.init()\nm = Mover\nm.go(1.0, 2.0)\n"), to="straight"),
    _script("main named only", "hello", "not_called", ("    main()\n", "    main\n"), words="main()"),
    _script("coroutine not awaited", "square", "never_awaited", ("    def move_square(self)", "    async def move_square(self)"), words="async"),
    _script("logged as debug", "hello", "wrong_level", ("get_logger().info", "get_logger().debug"), words="DEBUG"),
    _script("thread never started", "square", "thread_not_started", ("    node.move_square()\n", "    t = threading.Thread(target=node.move_square)\n    rclpy.spin(node)\n"), ("import time\n", "import time, threading\n"), words="t.start()"),
    _script("method never called", "square", "never_called", ("    node.move_square()\n", ""), words="move_square()"),
    _script("turn never called", "square", "never_called", (_TURN, ""), words="turn()"),
    _script("callback without a subscription", "", "never_called", ("", _BY_POSE.replace("        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n", "")), words="on_pose()", to="straight"),
    _script("pose that stays None", "", "never_filled",
            ("", _BARE + "class A:\n    pose = None\n    def __init__(self):\n        self.pose = None\n        node.create_timer(0.1, self.tick)\n    def tick(self):\n"
             "        if self.pose is None:\n            return\n        pub_a.publish(Twist())\na = A()\nrclpy.spin(node)\n"), words="self.pose = msg", to="straight"),
    _script("publish named only", "straight", "not_called", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub.publish"), words="self.cmd_vel_pub.publish(msg)"),
    _script("spin in a timer's callback", "straight", "spin_in_spin", ("        self.cmd_vel_pub.publish(msg)", "        rclpy.spin_once(self)\n        self.cmd_vel_pub.publish(msg)"), words="rclpy.spin_once()"),
    _script("two nodes, one after the other", "straight", "second_spin", ("    try:\n        rclpy.spin(node)", "    try:\n        rclpy.spin(rclpy.create_node('other'))\n        rclpy.spin(node)"), words="executor.add_node"),
    _script("guard inside of main", "straight", "guard_inside", ("\nif __name__ == '__main__':\n    main()", "\n    if __name__ == '__main__':\n        main()")),
    _script("log never reached", "hello", "log_not_reached", ("        # 打印日志", "    def hallo(self):\n        # 打印日志")),
    _script("log behind spin", "hello", "log_behind_spin", ("        self.get_logger().info('🎉 Hello ROS2! 我是第一个Python节点!')\n", ""),
            ("        # 4. 清理资源\n", "        node.get_logger().info('在')\n")),
    _script("loop before the publisher", "straight", "waits_in_loop", ("        # 创建发布者:", "        while True:\n            time.sleep(0.1)\n        # 创建发布者:"), ("import rclpy\n", "import rclpy, time\n")),
    _script("arguments of a thread without a comma", "square", "thread_crashed", ("    node.move_square()\n", "    threading.Thread(target=node.turn, args=(1.57)).start()\n"),
            ("import time\n", "import time, threading\n"), words="args=(1.57,)"),
    _script("action without its namespace", "straight", "action_nearly", ("self.timer = self", "from rclpy.action import ActionClient\n        from turtlesim.action import RotateAbsolute\n        client = ActionClient(self, RotateAbsolute, '/rotate_absolute')\n        client.wait_for_server()\n        self.timer = self"), words="/turtle1/rotate_absolute"),
    _script("exit passed over", "square", "never_called", ("    node.move_square()\n", "    try:\n        rclpy.spin(node)\n    except SystemExit:\n        pass\n")),
    _script("arguments that nobody gives", "square", "no_arguments", ("    node.move_square()\n", "    import argparse\n    parser = argparse.ArgumentParser()\n    parser.add_argument('side')\n    parser.parse_args()\n")),
    _script("thread called", "square", "thread_called", ("    node.move_square()\n", "    threading.Thread(target=rclpy.spin(node)).start()\n    node.move_square()\n"), ("import time\n", "import time, threading\n"), words="target=rclpy.spin, args="),
    _script("error hidden", "straight", "error_caught", ("        msg.linear.x = 1.0 ", "        try:\n            msg.linear.x = 1\n            self.cmd_vel_pub.publish(msg)\n        except:\n            pass\n        return\n        msg.linear.x = 1.0 "), words="except"),
    _script("compared for assigned", "straight", "compares_for_assigns", ("msg.linear.x = 1.0", "msg.linear.x == 1.0"), words="=="),
    _script("stopped at once", "straight", "stopped_at_once", ("msg.linear.x = 1.0", "msg.linear.x = 0.1"), ("publish(msg)\n", "publish(msg)\n        self.cmd_vel_pub.publish(Twist())\n")),
    _script("negative duration", "square", "only_stops", ("self.SIDE_LENGTH / self.SPEED", "-2.0"), ("1.5708 / self", "-1.57 / self")),
    _script("milliseconds for nanoseconds", "square", "too_brief", ("duration * 1e9", "duration * 1e6"), words="1e9"),
    _script("very slow turn", "spin", "turn_too_slow", ("TURN_SPEED = 1.0", "TURN_SPEED = 0.015")),
    _script("sides bent", "square", "kept_turning", ("        msg.linear.x = float(self.SPEED)\n        msg.angular.z = 0.0", "        msg.linear.x = float(self.SPEED)\n        msg.angular.z = 0.1"), words="angular.z|0.1"),
    _script("turned in the end only", "square", "turns_behind_loop", ("            self.turn(self.TURN_TIME)\n", "            if i == 3:\n                self.turn(self.TURN_TIME)\n"), ("self.SIDE_LENGTH = 2.0 ", "self.SIDE_LENGTH = 1.0 ")),
    _script("sideways square", "square", "sideways", ("        msg.linear.x = float(self.SPEED)\n", "        msg.linear.y = float(self.SPEED)\n")),
    # What is no Python.
    _script("else if", "hello", "else_if", (_INIT, _INIT + "    if args:\n        pass\n    else if not args:\n        pass\n"), words="elif"),
    _script("increment", "hello", "increment", (_INIT, "    i = 0\n    i++\n" + _INIT), words="i += 1"),
    _script("one equals sign", "hello", "single_equals", (_INIT, "    if args = 3:\n        pass\n" + _INIT), words="=="),
    _script("and of C", "hello", "c_operator", (_INIT, "    if args && args:\n        pass\n" + _INIT), words="and"),
    _script("type before the name", "hello", "typed_name", (_INIT, "    int i = 0\n" + _INIT)),
    _script("colon forgotten", "square", "missing_colon", ("for i in range(4):", "for i in range(4)")),
    _script("bracket forgotten", "square", "unbalanced", ("super().__init__('square_mover')", "super().__init__('square_mover'")),
    _script("Python 2", "hello", "print_statement", (_INIT, "    print 'hello'\n" + _INIT), words="print('...')"),
    _script("terminal commands", "hello", "shell_line", ("", "cd ~/ros2_ws\npython3 hello_node.py\n")),
    _script("a command in between", "hello", "shell_line", ("import rclpy\n", "ros2 run turtlesim turtlesim_node\nimport rclpy\n")),
    _script("line numbers", "", "line_numbers", ("", "1  import rclpy\n2  from rclpy.node import Node\n"), to="hello"),
    _script("degrees on the spot", "spin", "degrees_as_radians", ("TURN_SPEED = 1.0", "TURN_SPEED = 57.3"), ("(2.0 * math.pi + 0.05) / TURN_SPEED", "7.0"), words="57.3"),
    # What the script shows of the cause, beside what the car did.
    _script("global forgotten for a speed", "", "missing_global",
            ("", _BARE + "speed = 0.0\ndef tick():\n    speed += 0.1\n    m = Twist()\n    m.linear.x = speed\n    pub_a.publish(m)\n"
             "node.create_timer(0.1, tick)\nrclpy.spin(node)\n"), words="global speed|tick", to="straight"),
    _script("global forgotten in a method", "straight", "missing_global", ("class StraightMover", "cishu = 0\n\n\nclass StraightMover"),
            ("        msg = Twist()\n", "        cishu = cishu + 1\n        msg = Twist()\n"), words="global cishu"),
    _script("start calls itself", "square", "calls_itself", ("    node.move_square()\n", "    main()\n"), words="main()"),
    _script("init twice stays", "square", "init_twice", ("        super().__init__('square_mover')\n", "        rclpy.init()\n        super().__init__('square_mover')\n")),
    _script("method without self and with a time", "square", "lacks_self", ("def turn(self, duration)", "def turn(duration)"), words="def turn(self, duration):"),
    _script("timer callback wants a time", "straight", "timer_callback", ("def timer_callback(self)", "def timer_callback(self, t)"), words="def timer_callback(self):"),
    _script("argument forgotten in a call", "square", "call_mismatch", ("self.turn(self.TURN_TIME)", "self.turn()")),
    _script("timers overwritten", "straight", "private_taken", ("self.timer = ", "self._timers = "), words="self._timers"),
    _script("init in capitals", "hello", "misspelt_init", ("__init__(self)", "__Init__(self)"), words="__Init__"),
    _script("name of the node missing", "square", "no_node_name", ("__init__('square_mover')", "__init__()"), words="super().__init__('my_node')"),
    _script("a list of angles too short", "square", "list_too_short", ("        for i in range(4):\n", "        jiao = [1.5708, 1.5708]\n        for i in range(4):\n"),
            ("self.turn(self.TURN_TIME)", "self.turn(jiao[i])"), words="jiao|2|4|jiao[2]"),
    _script("pose in init", "straight", "none_in_init", ("        # 节点名\n", ""),
            ("        self.get_logger().info('🚀", "        self.pose = None\n        self.create_subscription(Twist, '/turtle1/pose2', self.on_pose, 10)\n"
             "        self.x0 = self.pose.linear\n        self.get_logger().info('🚀"),
            ("    def timer_callback", "    def on_pose(self, msg):\n        self.pose = msg\n\n    def timer_callback"), words="on_pose|self.pose"),
    _script("a launch file", "", "other_file", ("", "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([])\n"),
            words="rclpy.init()", to="hello"),
    _script("turtlesim started in the file", "", "only_shell", ("", "ros2 run turtlesim turtlesim_node\n"), words="publish(msg)", to="straight"),
    _script("commands above a program", "straight", "shell_line", ("", "source /opt/ros/humble/setup.bash\n")),
    _script("speed times the round", "square", "unequal_sides", ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME * (i + 1) / 2)")),
    _script("angle times the round", "square", "one_corner_off", ("self.turn(self.TURN_TIME)", "self.turn(i * self.TURN_TIME + 1.5708)")),
    _script("while without a count", "square", "wrong_lengths", ("        for i in range(4):\n", "        i = 0\n        while i < 4:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 0 else 1.0)"), to="rectangle"),
    _script("while unlike a count above", "square", "wrong_lengths", ("        for i in range(4):\n", "        i = 0\n        while i != 4:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 0 else 1.0)"), to="rectangle"),
    _script("while unlike a count below", "square", "wrong_lengths", ("        for i in range(4):\n", "        i = 4\n        while i != 0:\n"),
            ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIME if i == 4 else 1.0)"), to="rectangle"),
    _script("counts right", "square", "", ("        for i in range(4):\n", "        i = 0\n        while i < 4:\n            i = i + 1\n")),
    _script("times swapped", "square", "turns_too_far", ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.TURN_TIME)"),
            ("self.turn(self.TURN_TIME)", "self.turn(self.MOVE_TIME)")),
    _script("turn too long by itself", "square", "turns_too_far", ("1.5708 / self.TURN_SPEED", "1.8 / self.TURN_SPEED")),
    _script("break after the first", "square", "leaves_loop", (_TURN, _TURN + "            break\n"), words="break"),
    _script("break that never comes", "square", "sides_missing", ("range(4)", "range(3)"), (_TURN, _TURN + "            if i > 9:\n                break\n")),
    _script("pop in the loop", "square", "removes_in_loop", ("        for i in range(4):\n", "        bian = [0, 1, 2, 3]\n        for i in bian:\n"),
            (_TURN, _TURN + "            bian.pop()\n"), words="bian"),
    _script("two sides and no loop", "", "no_loop", ("", _BARE + "go(1.0, 0.0, 2)\npub_a.publish(Twist())\ngo(0.0, 1.0, 1.57)\npub_a.publish(Twist())\n"), to="square"),
    _script("clock, then a pause", "square", "no_turns",
            ("        start_time = self.get_clock().now()\n\n        while", "        start_time = self.get_clock().now()\n        time.sleep(2)\n        while")),
    _script("clock, then a short pause", "square", "", ("        start_time = self.get_clock().now()\n\n        while", "        start_time = self.get_clock().now()\n        time.sleep(0.01)\n        while")),
    _script("turn left to do", "square", "empty_function", ("        self.get_logger().info('↻ 旋转...')\n", "        pass\n\n    def turn_old(self, duration):\n        self.get_logger().info('↻ 旋转...')\n"),
            words="turn()"),
    _script("one for a third", "square", "no_turns", ("1.5708 / self.TURN_SPEED", "1 // 2 * 3.1416")),
    _script("speed cut to zero", "straight", "only_stops", ("msg.linear.x = 1.0", "msg.linear.x = float(int(0.8))")),
    _script("right turn with a negative time", "square", "no_turns", ("self.TURN_SPEED = 1.0 ", "self.TURN_SPEED = -0.5 ")),
    _script("radians of a rate", "spin", "turn_too_short", ("msg.angular.z = w", "msg.angular.z = math.radians(TURN_SPEED) if w else 0.0"), ("2.0 * math.pi + 0.05", "2.0 * math.pi")),
    _script("degrees of ninety", "square", "endless_turn", ("1.5708 / self.TURN_SPEED", "math.degrees(90) / self.TURN_SPEED"), ("import time", "import time\nimport math")),
    _script("radians of ninety", "square", "", ("1.5708 / self.TURN_SPEED", "math.radians(90) / self.TURN_SPEED"), ("import time", "import time\nimport math")),
    _script("once for all", "hello", "spin_once", ("rclpy.spin(node)", "rclpy.spin_once(node, timeout_sec=2.0)"), words="rclpy.spin(node)"),
    _script("spun in a loop", "straight", "", ("rclpy.spin(node)", "while rclpy.ok():\n            rclpy.spin_once(node)")),
    _script("letter O for the topic", "straight", "wrong_topic", ("'/turtle1/cmd_vel'", "'/turtle2/cmd_vel'")),
    _script("capital I for one", "straight", "lookalike", ("'/turtle1/cmd_vel'", "'/turtleI/cmd_vel'"), words="I"),
    _script("stops in a second timer", "straight", "timer_stops", ("msg.linear.x = 1.0", "msg.linear.x = 0.1"), ("(0.1, self.timer_callback)", "(0.1, self.timer_callback)\n        self.create_timer(0.1, self.halt)"),
            ("    def timer_callback", "    def halt(self):\n        msg = Twist()\n        msg.linear.x = 0.0\n        self.cmd_vel_pub.publish(msg)\n\n    def timer_callback"), words="halt"),
    _script("timer of a minute", "straight", "long_period", ("(0.1, self", "(60, self"), words="0.1"),
    _script("return above", "straight", "returns_before", ("        self.cmd_vel_pub.publish(msg)\n", "        return\n        self.cmd_vel_pub.publish(msg)\n")),
    _script("class of another lesson", "straight", "class_not_made", ("    node = StraightMover()\n", "    node = Node('straight')\n"), words="StraightMover()"),
    _script("math as m", "square", "imported_as", ("import time\n", "import time as t\n"), words="import time"),
    _script("log with a plus", "square", "text_plus_number", ("f'━━━ 第 {i+1}/4 条边 ━━━'", "'边' + i"), words="str("),
    _script("publisher after the drive", "square", "called_too_early", ("        super().__init__('square_mover')\n", "        super().__init__('square_mover')\n        self.stop()\n")),
    _script("number for a method", "square", "method_overwritten", ("        # ============ 参数设置", "        self.stop = 0\n        # ============ 参数设置"), words="stop"),
    _script("a module of one's own", "hello", "own_module", ("import rclpy\n", "import rclpy\nfrom my_tools import helper\n"), words="my_tools"),
    _script("left, right, left", "", "swings", ("", "import math, rclpy\nfrom rclpy.node import Node\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
            "class Go(Node):\n    def __init__(self):\n        super().__init__('go')\n        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
            "        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)\n    def on_pose(self, p):\n        m = Twist()\n"
            "        e = math.remainder(math.atan2(3.0 - p.y, 8.0 - p.x) - p.theta, math.tau)\n        if math.hypot(8.0 - p.x, 3.0 - p.y) > 0.1:\n"
            "            if abs(e) > 0.0005:\n                m.angular.z = 1.5 if e > 0 else -1.5\n            else:\n                m.linear.x = 1.0\n        self.pub.publish(m)\n"
            "rclpy.init()\nrclpy.spin(Go())\n"), words="angular.z = 2.0", to="go_to_goal"),
    # Blanks of a template, and what chat agents write around code.
    _script("blank of a template", "square", "unfinished_line", ("duration * 1e9:", "____ * 1e9:"), words="49"),
    _script("nothing behind the equals sign", "straight", "unfinished_line", ("msg.linear.x = 1.0 ", "msg.linear.x = "), words="37"),
    _script("place for the speed", "straight", "unfinished_line", ("msg.linear.x = 1.0 ", "msg.linear.x = <速度> "), words="37"),
    _script("method that is still a comment", "square", "empty_block", ("        msg = Twist()\n        msg.linear.x = 0.0\n        msg.angular.z = 0.0\n        self.cmd_vel_pub.publish(msg)\n        time.sleep(0.1)\n", "        # TODO\n"), ('        """停止运动"""\n', ""), words="74|pass"),
    _script("body that is not indented", "square", "indentation", ("    rclpy.init(args=args)\n", "rclpy.init(args=args)\n"), words="97"),
    _script("what the code does, behind it", "square", "prose", ("    main()\n", "    main()\n\n说明：\n1. 可以改速度\n"), words="113"),
    _script("here is the code", "hello", "prose", ("", "Here is the complete code:\n\n"), words="1"),
    _script("function of another language", "square", "misspelt_keyword", ("def stop(self)", "function stop(self)"), words="def"),
    _script("hyphen in a function's name", "square", "blank_in_name", ("def move_square", "def move-square"), words="82"),
    _script("comma between objects", "", "missing_comma", ("", "from dataclasses import dataclass\nSTEPS = [dict(v=1.0) Twist(v=2.0)]\n"), words="2", to="square"),
    _script("list for a number", "straight", "list_in_float", ("msg.linear.x = 1.0 ", "msg.linear.x = [1.0]"), words="37"),
    _script("comma in a pause", "square", "comma_in_float", ("time.sleep(0.1)", "time.sleep(0,1)"), words="80"),
    _script("half an index", "square", "whole_number", ("self.turn(self.TURN_TIME)", "self.turn([self.TURN_TIME] * 9 and [1.5708] [i / 1])"), words="//"),
    _script("pi as a letter", "square", "other_language", ("1.5708 /", "π / 2 /"), words="math.pi"),
    # An attribute without a value is not misspelt, whatever Python suggests.
    _script("count that begins nowhere", "straight", "unknown_attribute", ("        msg = Twist()\n", "        self.timer_call += 1\n        msg = Twist()\n"), words="timer_call"),
    _script("called at once in a callback", "", "callback_called_here", ("", _CHAIN), ("self.t = self.create_timer(1.0", "self.first = self.create_timer(1.0"), ("self.t.cancel()\n        if", "self.first.cancel()\n        if"), ("(2.0, self.turn)", "(2.0, self.turn())"), words="self.turn", to="square"),
    # Classes beside the node.
    _script("two classes", "", "", ("", _HELPED), to="straight"),
    _script("helper without its init", "", "no_init", ("", _HELPED), ("def __init__(self, node)", "def _init_(self, node)"), words="Wheels|__init__", to="straight"),
    _script("helper without its node", "", "init_mismatch", ("", _HELPED), ("Wheels(self)", "Wheels()"), words="Wheels", to="straight"),
    # Timers that are meant to fire once.
    _script("chain of timers", "", "", ("", _CHAIN), to="square"),
    _script("chain of timers that are not cancelled", "", "timer_repeats", ("", _CHAIN), ("    def turn(self):\n        self.t.cancel()\n", "    def turn(self):\n"), words="turn()", to="square"),
    _script("timer that makes timers", "straight", "", ("        msg = Twist()\n", "        self.timer.cancel()\n        self.timer = self.create_timer(0.1, self.timer_callback)\n        msg = Twist()\n")),
    # Where the pause, the publish or the loop stands.
    _script("pause behind the loop", "", "turns_too_short", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("        pub_a.publish(m)\n        time.sleep(0.02)\n", "        pub_a.publish(m)\n    time.sleep(0.1)\n"), to="square"),
    _script("message that is not sent", "square", "never_sent", ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        self.stop()", "            time.sleep(0.01)\n\n        self.stop()"), words="63|turn()|self.cmd_vel_pub.publish(msg)"),
    _script("only the first side", "square", "leaves_loop", ("            self.turn(self.TURN_TIME)\n", "            break\n            self.turn(self.TURN_TIME)\n"), words="break"),
    _script("whole turns for corners", "square", "turns_too_far", ("1.5708 / self", "6.2832 / self"), words="360"),
    # Never to be told where it is not so.
    _script("cancelled at the end only", "", "only_stops", ("", _STEPS), words="* 1e9", to="square"),
    _script("without its timer", "", "never_called", ("", _STEPS), ("        self.timer = self.create_timer(0.05, self.tick)\n", ""), ("            self.timer.cancel()\n", ""), ("    rclpy.spin(node)\n", "    try:\n        rclpy.spin(node)\n    except KeyboardInterrupt:\n        pass\n    if rclpy.ok():\n        rclpy.shutdown()\n"), words="tick()", to="square"),
    _script("slow rate in the main thread", "", "", ("", _RATED), to="straight"),
    _script("slow rate that is far too slow", "", "endless_turn", ("", _RATED), ("mover.go(1.0, 0.0, 30)", "mover.go(0.0, 1.0, 100)\n    mover.go(1.0, 0.0, 30)"), to="square"),
    _script("thread without its comma", "", "thread_crashed", ("", _RATED), ("args=(mover,)", "args=(mover)"), words="args=(mover,)", to="straight"),
    _script("misspelt call that an except hides", "square", "error_caught", ("    node.move_square()\n", "    try:\n        node.move_squar()\n    except:\n        pass\n"), words="move_squar"),
    _script("too large a number is refused", "square_input", "ended_before_init", ("    rclpy.init()\n", "    if not __file__.endswith('x'):\n        print('no')\n        return\n    rclpy.init()\n"), words="rclpy.init()"),
    _script("input that int refuses", "square_input", "ended_before_init", ("    rclpy.init()\n", "    try:\n        side = int(input())\n    except ValueError:\n        print('no')\n        return\n    rclpy.init()\n"), ("    node.side = float(input('请输入边长（米）：'))\n", "    node.side = float(side)\n"), words="1.5"),
    _script("degrees for the corner of an L", "letter_l", "path_endless_turn", ("abs(math.radians(degrees)) / 1.0)\n\n    def arc", "abs(degrees) / 1.0)\n\n    def arc"), words="math.radians(90)"),
    # By place and heading.
    _script("from point to point", "", "", ("", _POINTS), to="square"),
    _script("turns while it drives", "", "arcs_by_pose", ("", _POINTS), ("abs(err) > 0.02", "abs(err) > 0.5"), ("0.5 * err", "2.0 * err"), to="square"),
    _script("the same point for ever", "", "no_turns_by_pose", ("", _POINTS), ("self.k += 1", "pass"), words="abs(", to="square"),
    _script("axes exchanged in a square", "", "side_goes_on", ("", _POINTS), ("atan2(gy - p.y, gx - p.x)", "atan2(gx - p.x, gy - p.y)"), to="square"),
    _script("degrees of theta", "", "side_goes_on", ("", _POINTS), ("- p.theta\n", "- math.degrees(p.theta)\n"), to="square"),
    _script("present less wanted", "", "swings", ("", _POINTS), ("m.angular.z = 2.0 * err", "m.angular.z = 2.0 * fold(p.theta - goal)"), ("            if dist < 0.03", "            goal = math.atan2(gy - p.y, gx - p.x)\n            if dist < 0.03"), to="square"),
    _script("wrong sign within limits", "", "never_finished", ("", _POINTS), ("m.angular.z = 2.0 * err", "m.angular.z = max(-1.0, min(1.0, -2.0 * err))"), to="square"),
    _script("callback without global", "", "kept_global", ("", _HEARD), ("    global pose\n", ""), words="global pose", to="straight"),
    _script("thread that hears nothing", "", "thread_not_started", ("", _HEARD), (".start()", ""), words=".start()", to="straight"),
    _script("heard in a thread", "", "", ("", _HEARD), to="straight"),
    # Errors that are caught and shown.
    _script("error that is printed", "square", "error_caught", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print('出错', e)\n"), ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIMES)"), words="MOVE_TIMES"),
    _script("spin below a false condition", "hello", "not_spinning", ("        rclpy.spin(node)\n    except KeyboardInterrupt:", "        if not rclpy.ok():\n            rclpy.spin(node)\n    except Exception:")),
    # Loops.
    _script("count behind its loop", "", "side_never_ends", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("    for _ in range(round(t * 50)):\n        pub_a.publish(m)\n        time.sleep(0.02)\n", "    n = 0\n    while n < t * 50:\n        pub_a.publish(m)\n        time.sleep(0.02)\n    n += 1\n"), to="square"),
    _script("end that is put off", "square", "endless_turn", ("        start_time = self.get_clock().now()\n\n        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:\n            self.cmd_vel_pub.publish(msg)", "        end = time.time() + duration\n        while time.time() < end:\n            end = time.time() + duration\n            self.cmd_vel_pub.publish(msg)")),
    _script("compared in a method of all motions", "", "compares_for_assigns", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.5708)\n"), ("m.linear.x = v", "m.linear.x == v"), words="m.linear.x = v", to="square"),
    # What is not ROS.
    _script("module for a base class", "hello", "no_base_class", ("class HelloNode(Node)", "class HelloNode(rclpy)"), words="Node"),
    _script("name for the logger", "hello", "takes_nothing", ("self.get_logger()", "self.get_logger('hello')"), words="get_logger()"),
    _script("function that wants a value, only named", "letter_l", "not_called", ("        self.turn(90.0)\n", "        self.turn\n"), words="self.turn(...)"),
    _script("callback that reads what it is not given", "", "subscription_callback", ("", _POINTS), ("def on_pose(self, p)", "def on_pose(self)"), ("x, y, s = p.x, p.y, 2.0", "x, y, s = pose.x, pose.y, 2.0"), words="def on_pose(self, pose):", to="square"),
    _script("message with brackets", "", "not_callable", ("", _HEARD), ("x = pose.x", "x = pose.x()"), words="()", to="straight"),
    _script("arcs of a script that steers", "", "arcs_by_pose", ("", _POINTS), ("abs(err) > 0.02", "err * err > 0.3"), ("0.5 * err", "2.0 * err"), words="0.02", to="square"),
    _script("publisher called itself", "straight", "publish_left_out", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub(msg)"), words="41"),
    _script("publish of nothing", "straight", "publish_left_out", ("self.cmd_vel_pub.publish(msg)", "publish(msg)"), words="41"),
    _script("publish with a letter too few", "straight", "misspelt", ("self.cmd_vel_pub.publish(msg)", "self.cmd_vel_pub.publis(msg)"), words="publish"),
    _script("period with a comma", "straight", "timer_arguments", ("create_timer(0.1,", "create_timer(0, 1,"), words="28"),
    _script("import with a capital", "square", "misspelt_keyword", ("from rclpy.node import Node", "from rclpy.node Import Node"), words="Import"),
    _script("return in the loop of a motion", "square", "leaves_loop", ("            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.01)\n\n        self.stop()", "            self.cmd_vel_pub.publish(msg)\n            time.sleep(0.2)\n            return\n\n        self.stop()"), words="return"),
    _script("whole seconds of a message", "square", "turns_too_far", ("start_time = self.get_clock().now()", "start_time = self.get_clock().now().to_msg().sec"), ("(self.get_clock().now() - start_time).nanoseconds < duration * 1e9", "self.get_clock().now().to_msg().sec - start_time < duration")),
    _script("whole seconds by division", "square", "turns_too_far", (".nanoseconds < duration * 1e9", ".nanoseconds // 1e9 < duration")),
    _script("ten times too many nanoseconds", "square", "endless_turn", ("duration * 1e9", "duration * 10e9")),
    _script("count with its letters exchanged", "straight", "misspelt", ("        self.timer = ", "        self.count = 0\n        self.timer = "), ("        msg = Twist()\n", "        self.conut += 1\n        msg = Twist()\n"), words="count"),
    _script("timer that is told to stop", "straight", "misspelt", ("        msg = Twist()\n", "        self.timer.stop()\n        msg = Twist()\n"), words="cancel"),
    _script("error that is caught before a last stop", "square", "error_caught", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n    node.stop()\n"), ("self.move_straight(self.MOVE_TIME)", "self.move_straight(self.MOVE_TIMES)"), words="MOVE_TIMES"),
    # What is there, and is not the cause.
    _script("stops that are sent again and again", "", "one_radian", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 1.0)\n"), ("        pub_a.publish(m)\n        time.sleep(0.02)\n", "        pub_a.publish(m)\n        time.sleep(0.02)\n    m = Twist()\n    for _ in range(3):\n        pub_a.publish(m)\n    time.sleep(0.1)\n"), to="square"),
    _script("whole seconds of a limit", "square", "turns_too_short", ("        for i in range(4):\n", "        begun = int(time.time())\n        for i in range(4):\n            if int(time.time()) - begun > 90:\n                break\n"), ("1.5708 /", "1.3 /")),
    _script("whole seconds of a difference", "square", "turns_too_far", ("start_time = self.get_clock().now()", "start_time = time.time()"), ("(self.get_clock().now() - start_time).nanoseconds < duration * 1e9", "int(time.time() - start_time) < duration")),
    _script("timer that begins later", "", "one_radian", ("", _CHAIN), ("        self.create_timer(0.02, self.send)\n", "        self.once = self.create_timer(0.5, self.begin)\n"), ("    def forward(self):\n", "    def begin(self):\n        self.once.cancel()\n        self.create_timer(0.02, self.send)\n    def forward(self):\n"), ("1.5708", "1.0"), to="square"),
    _script("error that ends the first side", "square", "error_caught", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n"), ("self.turn(self.TURN_TIME)", "self.turn(self.TURN_TIMES)"), words="91|Did you mean: 'TURN_TIME'"),
    _script("error of a log that is caught", "square", "sides_missing", ("range(4)", "range(3)"), ("    node.move_square()\n", "    try:\n        node.get_logger().inform('go')\n    except Exception:\n        pass\n    node.move_square()\n")),
    _script("corners in two parts", "", "crooked", ("", _BARE + "for i in range(4):\n    go(1.0, 0.0, 2.0)\n    go(0.0, 1.0, 0.7854)\n    go(1.0, 0.0, 0.4)\n    go(0.0, 1.0, 0.7854)\npub_a.publish(Twist())\n"), to="square"),
    _script("text for the logger", "hello", "takes_nothing", ("self.get_logger().info(", "self.get_logger("), words="get_logger().info('...')"),
    _script("node with a letter too few", "straight", "misspelt", ("rclpy.spin(node)", "rclpy.spin(nod)"), words="node"),
    _script("whole seconds that nothing compares", "square", "one_radian", ("import time\n", "import time\nSEED = int(time.time())\n"), ("1.5708 /", "1.0 /")),
    _script("arguments that are forgotten in a try", "square", "error_caught", ("    node.move_square()\n", "    try:\n        node.move_square()\n    except Exception as e:\n        print(e)\n"), ("self.turn(self.TURN_TIME)", "self.turn()"), words="turn()|57"),
)  # fmt: skip
