# ruff: noqa: E501 - one case a line, to be compared with its neighbours
"""What the text of a script shows about an exception, and where it must show nothing."""

import pytest

from grader.contracts.outcome import StudentError
from grader.messages.exceptions import meaning
from grader.messages.script import ScriptText


def told(kind: str, message: str, source: str, line: int, more: str = "") -> tuple[str, str]:
    """Return code and English text for an exception that the given line of `source` raised."""
    written = source.split("\n")[line - 1].strip()
    shown = f'Traceback (most recent call last):\n  File "script.py", line {line}, in f\n    {written}\n'
    error = StudentError(type=kind, message=message, line=line, traceback=f"{shown}{kind}: {message}{more}")
    code, text = meaning(error, "crashed", ScriptText(source))
    assert text.zh
    return code, text.en


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("tiem", "time"),
        ("maht", "math"),
        ("jsno", "json"),
        ("datetme", "datetime"),
        ("turtlsim", "turtlesim"),
    ],
)
def test_a_misspelt_module_is_no_other_file_of_the_author(name: str, wanted: str) -> None:
    code, text = told("ModuleNotFoundError", f"No module named '{name}'", f"import {name}", 1)
    assert code == "misspelt"
    assert f"'{wanted}'" in text


def test_an_unknown_module_may_be_another_file_of_the_author() -> None:
    assert told("ModuleNotFoundError", "No module named 'helper'", "import helper", 1)[0] == "own_module"


def test_a_misspelt_field_of_a_response_names_its_type() -> None:
    message = "'Move_Response' object has no attribute 'sucess'"
    code, text = told("AttributeError", message, "r.sucess = True", 1, ". Did you mean: 'success'?")
    assert code == "misspelt_field"
    assert "Move_Response has no field sucess; it is called success" in text


LIST = "def f():\n    xs = {made}\n    for i in range(4):\n        print(xs[i])\n"
RANGE = "list index out of range"


@pytest.mark.parametrize(
    ("message", "line", "wanted"),
    [
        ("pop from empty list", "v, w = self.plan.pop(0)", "self.plan is empty by then"),
        ("pop from an empty deque", "x = goals.popleft()", "goals is empty by then"),
    ],
)
def test_what_is_taken_from_an_empty_list_is_told(message: str, line: str, wanted: str) -> None:
    code, text = told("IndexError", message, line, 1)
    assert code == "list_empty"
    assert wanted in text


def test_a_list_is_too_short_for_the_loop_around() -> None:
    assert told("IndexError", RANGE, LIST.format(made="[1, 2, 3]"), 4)[0] == "list_too_short"


@pytest.mark.parametrize(
    "source",
    [
        LIST.format(made="[P(0, 0)]"),
        LIST.format(made="[]") + "    xs.append(1)\n",
        LIST.format(made="[1, 2]") + "    xs += [3]\n",
        "xs = [1]\n\n\nprint(xs[i])\nfor i in range(9):\n    pass\n",
    ],
)
def test_no_length_of_a_list_is_told_that_its_line_does_not_show(source: str) -> None:
    assert told("IndexError", RANGE, source, 4)[0] == "index_range"


@pytest.mark.parametrize(
    ("above", "parameters", "message"),
    [
        ("@staticmethod", "a, b", "missing 1 required positional argument: 'b'"),
        ("@staticmethod", "a", "takes 1 positional argument but 2 were given"),
        ("@classmethod", "cls", "takes 1 positional argument but 2 were given"),
        ("pass", "this, t", "takes 2 positional arguments but 3 were given"),
    ],
)
def test_a_method_without_self_that_needs_none_is_not_told_to_lack_it(
    above: str, parameters: str, message: str
) -> None:
    source = f"class A:\n    {above}\n    def go({parameters}):\n        pass\nA().go(1, 2)\n"
    assert told("TypeError", f"A.go() {message}", source, 5)[0] == "wrong_parameters"


def test_a_method_without_self_is_told_to_lack_it() -> None:
    source = "class A:\n    def go(t):\n        pass\nA().go(1)\n"
    assert (
        told("TypeError", "A.go() takes 1 positional argument but 2 were given", source, 4)[0] == "lacks_self"
    )


def test_a_callback_that_reads_as_it_should_is_not_told_to_be_changed() -> None:
    source = (
        "class A(Node):\n    def __init__(self):\n        self.create_timer(0.1, self.go)\n"
        "        self.create_subscription(Pose, '/p', self.go, 10)\n    def go(self):\n        pass\nspin(n)\n"
    )
    code, _ = told("TypeError", "A.go() takes 1 positional argument but 2 were given", source, 7)
    assert code != "timer_callback"


NONE = "'NoneType' object has no attribute 'x'"
INIT = "class A(Node):\n    def __init__(self):\n        self.{name} = {value}\n        {line}\n"


@pytest.mark.parametrize(("value", "code"), [("self.get_logger()", "still_none"), ("'a'", "private_taken")])
def test_a_value_of_node_that_is_kept_under_its_own_name_is_not_taken(value: str, code: str) -> None:
    source = INIT.format(name="_logger", value=value, line="self.get_logger().info(self.a.x)")
    assert told("AttributeError", NONE, source, 4)[0] == code


@pytest.mark.parametrize(("given", "code"), [("pose", "none_in_init"), ("other", "still_none")])
def test_a_value_that_no_message_brings_is_not_told_to_wait_for_one(given: str, code: str) -> None:
    source = INIT.format(name="pose", value="None", line="self.y = self.pose.x") + (
        f"        self.create_subscription(Pose, '/p', self.cb, 10)\n"
        f"    def cb(self, msg):\n        self.{given} = msg\n"
    )
    assert told("AttributeError", NONE, source, 4)[0] == code


@pytest.mark.parametrize(
    ("line", "code"),
    [("x = 3 – 2", "dash_for_minus"), ("x = –2", "dash_for_minus"), ("第一步 — 初始化", "foreign_character")],
)
def test_a_dash_in_words_is_no_minus_sign(line: str, code: str) -> None:
    number = "U+2014" if "—" in line else "U+2013"
    assert told("SyntaxError", f"invalid character '—' ({number}) (script.py, line 1)", line, 1)[0] == code


@pytest.mark.parametrize(
    ("parameters", "code"),
    [
        ("self, response, request", "handler_order"),
        ("res, req", "handler_order"),
        ("self, request, response", "unknown_part"),
    ],
)
def test_a_handler_with_its_parameters_exchanged_is_told(parameters: str, code: str) -> None:
    source = f"def handle({parameters}):\n    response.names = []\n    return response\n"
    message = "'GetNames_Request' object has no attribute 'names'"
    assert told("AttributeError", message, source, 2)[0] == code


CAR = (
    "class Car(Node):\n    def __init__(self):\n        super().__init__('car')\n        self.side = 2.0\n        {init}\n"
    "    def go(self, t):\n        {go}\n{more}def main():\n    car = Car()\n    {main}\n"
)
"""`init` is line 5, `go` line 7; `main` is line 10 where `more` is empty."""


def car(*, init: str = "pass", go: str = "pass", more: str = "", main: str = "pass") -> str:
    return CAR.format(init=init, go=go, more=more, main=main)


HEARD = car(init="self.create_subscription(Pose, '/p', self.go, 10)", go="{line}")


@pytest.mark.parametrize(
    ("kind", "message", "source", "line", "code", "words"),
    [
        ("NameError", "name 'go' is not defined", car(main="go(1.0)"), 10, "missing_object", "car.go(...)"),
        ("NameError", "name 'side' is not defined", car(main="go(side)"), 10, "missing_object", "car.side"),
        ("NameError", "name 'side' is not defined", car(go="x = side"), 7, "missing_self_value", "self.side"),
        ("NameError", "name 'v' is not defined", "class A:\n    v = 1\n    def f(self):\n        v\n", 4, "missing_self_value", "self.v"),
        ("NameError", "name 'n' is not defined", "def f():\n    n = 1\ndef g():\n    go(n)\n", 4, "local_of_function", "f()"),
        ("NameError", "name 'f' is not defined", "f()\n\ndef f():\n    pass\n", 1, "defined_below", "line 3"),
        ("NameError", "name 'pose' is not defined", HEARD.format(line="self.x = pose"), 7, "parameter_called", "write t instead of pose"),
        ("NameError", "name 'pose' is not defined", HEARD.format(line="self.pose = pose"), 7, "parameter_called", "called t"),
        ("NameError", "name 'LIMIT' is not defined", HEARD.format(line="self.x = LIMIT"), 7, "unknown_name", "LIMIT"),
        ("NameError", "name 'pose' is not defined", HEARD.format(line="self.x = pose.x - t.x"), 7, "unknown_name", "pose"),
        ("NameError", "name 'side' is not defined", "self.get_parameter(side).value", 1, "name_without_quotes", "'side'"),
        ("AttributeError", "'Car' object has no attribute 'f'", car(go="self.f()", more="        def f(self):\n            pass\n"), 7, "method_inside", "line 8"),
        ("AttributeError", "'Car' object has no attribute 'f'", car(go="self.f()", more="def f():\n    pass\n"), 7, "not_of_self", "f(...)"),
        ("AttributeError", "'Car' object has no attribute 'f'", car(go="self.f()", more="class B:\n    def f(self):\n        pass\n"), 7, "unknown_attribute", "'f'"),
        ("AttributeError", "'Car' object has no attribute 'X'", "X, Y = 1, 2\n" + car(go="self.X"), 8, "not_of_self", "line 1"),
        ("AttributeError", "'Car' object has no attribute 'm'", car(go="m = Twist(); self.m.x").replace("; ", "\n        "), 8, "not_of_self", "line 7"),
        ("AttributeError", "'Car' object has no attribute 'v'", car(go="self.v", main="v = 1"), 7, "local_only", "car.v"),
        ("AttributeError", "'Car' object has no attribute 'v'", car(go="self.v").replace("    car = ", "    v = 1\n    car = "), 7, "unknown_attribute", "'v'"),
        ("AttributeError", "'Car' object has no attribute 'create_subscriber'", car(), 7, "misspelt", "'create_subscription'"),
        ("AttributeError", "'Car' object has no attribute 'get_time'", car(), 7, "misspelt", "get_clock().now()"),
        ("AttributeError", "'Publisher' object has no attribute 'send'", car(), 7, "publish_left_out", "'send'"),
        ("AttributeError", "'Publisher' object has no attribute 'send'", car(go="self.p.send(msg)"), 7, "publish_left_out", "'send'"),
        ("AttributeError", "'Publisher' object has no attribute 'cancel'", car(go="self.p.cancel()"), 7, "unknown_in_library", "'cancel'"),
        ("AttributeError", "'Publisher' object has no attribute 'linear'", car(go="m = Twist(); self.p.linear.x = 1.0").replace("; ", "\n        "), 8, "misspelt", "m.linear"),
        ("AttributeError", "'Car' object has no attribute '___'", car(go="self.___(msg)"), 7, "unfinished_line", "___"),
        ("ImportError", "cannot import name '____' from 'geometry_msgs.msg'", "from geometry_msgs.msg import ____\n", 1, "unfinished_line", "____"),
        ("NameError", "name '_' is not defined", "print(_)\n", 1, "unknown_name", "'_'"),
        ("NameError", "name 'XX' is not defined", car(init="self.XX = 1", go="XX"), 7, "missing_self_value", "self.XX"),
        ("AssertionError", "The 'x' field must be of type 'float'", "m.linear.x = [1.0]\n", 1, "list_in_float", "brackets"),
        ("AssertionError", "The 'x' field must be of type 'float'", "m.linear.x = [1, 2][0]\n", 1, "int_in_float", "1.0"),
        ("AssertionError", "The 'x' field must be of type 'float'", "m.linear.x = ...\n", 1, "unfinished_line", "not finished"),
        ("IndentationError", "expected an indented block after class definition on line 1", "class A(Node):\ndef f(self):\n    pass\n", 2, "indentation", "line 2"),
        ("IndentationError", "expected an indented block after class definition on line 1", "class A(Node):\ndef f():\n    pass\n", 2, "empty_block", "line 1"),
        ("IndentationError", "expected an indented block after 'for' statement on line 1", "for i in range(4):\n", 1, "empty_block", "line 1"),
        ("AttributeError", "module 'geometry_msgs' has no attribute 'msg'", car(), 7, "import_statement", "import geometry_msgs.msg"),
        ("AttributeError", "'Twist' object has no attribute 'x'", HEARD.format(line="t = Twist(); t.x").replace("; ", "\n        "), 8, "message_replaced", "Line 7"),
        ("AttributeError", "'Twist' object has no attribute 'x'", HEARD.format(line="t = Twist(); self.p = t").replace("; ", "\n        ") + "car.f(self.p.x)\n", 12, "message_replaced", "Line 7"),
        ("AttributeError", "'Twist' object has no attribute 'x'", HEARD.format(line="m = Twist(); m.x").replace("; ", "\n        "), 8, "unknown_field", "no field x"),
        ("AttributeError", "'Move_Response' object has no attribute 'x'", "def f(self, response, request):\n    request.x\n", 2, "handler_order", "(request, response)"),
        ("UnboundLocalError", "local variable 'time' referenced before assignment", "import time\ndef f():\n    time = time.time()\n", 3, "hidden_module", "time"),
        ("TypeError", "Car.go() missing 1 required positional argument: 'self'", car(init="self.create_timer(1, Car.go)"), 10, "class_for_self", "Line 5"),
        ("TypeError", "Car.go() missing 1 required positional argument: 'self'", "class Car(Node):\n    @staticmethod\n    def go(self):\n        pass\n", 4, "static_with_self", "Line 2"),
        ("TypeError", "Node.create_publisher() missing 1 required positional argument: 'qos_profile'", car(init="Node.create_publisher(Twist, '/a', 10)"), 5, "class_for_self", "self.create_publisher"),
        ("TypeError", "Node.create_publisher() missing 1 required positional argument: 'qos_profile'", car(init="self.create_publisher(Twist, 10)"), 5, "endpoint_arguments", "(Twist, '/turtle1/cmd_vel', 10)"),
        ("TypeError", "Node.create_publisher() missing 1 required positional argument: 'qos_profile'", car(init="self.create_publisher(Twist, '/a')"), 5, "missing_qos", "10"),
        ("TypeError", "Node.create_subscription() missing 2 required positional arguments: 'callback' and 'qos_profile'", car(init="self.create_subscription(Twist, '/a')"), 5, "endpoint_arguments", "self.callback"),
        ("TypeError", "cb() missing 1 required positional argument: 'e'", "def cb(e):\n    pass\nnode.create_timer(1, cb)\nrclpy.spin(node)\n", 4, "timer_callback", "def cb():"),
        ("TypeError", "cb() takes 0 positional arguments but 1 was given", "def cb():\n    pass\nnode.create_subscription(Pose, '/p', cb, 10)\nrclpy.spin(node)\n", 4, "subscription_callback", "def cb(msg):"),
        ("TypeError", "cb() takes 0 positional arguments but 1 was given", "def cb():\n    pass\ncb(1)\n", 3, "call_mismatch", "def cb(...)"),
        ("TypeError", "A.f.<locals>.<lambda>() takes 0 positional arguments but 1 was given", "rclpy.spin(n)", 1, "lambda_parameters", "lambda msg: ..."),
        ("TypeError", "Car.go() got an unexpected keyword argument 'time'", car(main="car.go(time=1)"), 10, "keyword_of_own", "def go(...)"),
        ("TypeError", "f() got an unexpected keyword argument 'time'", "f(time=1)", 1, "crashed", "f()"),
        ("TypeError", "spin_once() got an unexpected keyword argument 'timeout'", "rclpy.spin_once(n, timeout=1)", 1, "spin_timeout", "timeout_sec=0.1"),
        ("TypeError", "Executor.spin() takes 1 positional argument but 2 were given", "ex.spin(n)", 1, "executor_spin", "add_node"),
        ("TypeError", "spin_until_future_complete() missing 1 required positional argument: 'future'", "rclpy.spin_until_future_complete(n)", 1, "future_missing", "call_async"),
        ("TypeError", "'module' object is not callable", "import time, math\nx = time()", 2, "module_called", "time.time()"),
        ("TypeError", "'module' object is not callable", "import time, math\nx = time() + math()", 2, "crashed", "module"),
        ("TypeError", "'str' object is not callable", "n.create_timer(1, 'cb')\nrclpy.spin(n)", 2, "callback_as_text", "Line 1"),
        ("TypeError", "'str' object is not callable", "n.create_timer(1, cb)\nrclpy.spin(n)", 2, "not_callable", "Line 2"),
        ("TypeError", "Node.__init__() takes 2 positional arguments but 3 were given", "super().__init__(self, 'a')", 1, "node_name_only", "without self"),
        ("TypeError", "Node.__init__() got an unexpected keyword argument 'anonymous'", "super().__init__('a', anonymous=True)", 1, "node_name_only", "'my_node'"),
        ("TypeError", "Node.__init__() missing 1 required positional argument: 'node_name'", "n = Node()", 1, "node_needs_name", "Node('my_node')"),
        ("TypeError", "super() argument 1 must be a type, not str", "super('a').__init__()", 1, "super_brackets", "super().__init__"),
        ("TypeError", "can't multiply sequence by non-int of type 'float'", "x = [1] * 0.5", 1, "sequence_times_number", "sides[0]"),
        ("TypeError", "can't multiply sequence by non-int of type 'float'", "x = input()\nx * 0.5", 2, "text_for_number", "float("),
        ("TypeError", "unsupported operand type(s) for /: 'ParameterValue' and 'float'", "x / 2.0", 1, "parameter_value", ".value"),
        ("TypeError", "unsupported operand type(s) for +: 'Time' and 'float'", "c.sleep_for(0.1)", 1, "sleeps_duration", "Duration(seconds=0.1)"),
        ("ParameterAlreadyDeclaredException", "('Parameter(s) already declared', ['side'])", "", 1, "declared_twice", "once"),
        ("NotImplementedError", "Action classes can not be instantiated", "Move()", 1, "action_class", "Goal()"),
        ("ValueError", "math domain error", "math.sqrt(x)", 1, "math_domain", "math.hypot(dx, dy)"),
        ("AssertionError", "The 'success' field must be of type 'bool'", "r.success = 1", 1, "wrong_type_in_field", "True"),
        ("RecursionError", "maximum recursion depth exceeded", car(go="self.log(); self.go(t)").replace("; ", "\n        "), 7, "recursion", "Line 8"),
        ("NameError", "name '前进' is not defined", "print(前进)", 1, "words_in_code", "print('...')"),
        ("NameError", "name '前近' is not defined", "前进 = 1\nprint(前近)", 2, "unknown_name", "前近"),
        ("NameError", "name 'rospy' is not defined", "while not rospy.is_shutdown():", 1, "ros_1_habit", "not rclpy.ok()"),
        ("TypeError", "unsupported operand type(s) for -: 'float' and 'Time'", car(), 7, "time_and_number", "time.time()"),
        ("TypeError", "unsupported operand type(s) for -: 'float' and 'Duration'", car(), 7, "duration_and_number", "Duration"),
        ("NotInitializedException", "", car(main="pass").replace("    car =", "    rclpy.init()\n    rclpy.shutdown()\n    car ="), 3, "shutdown_early", "line 10"),
        ("ParameterNotDeclaredException", "('Invalid access to undeclared parameter(s)', 'Side')", "self.declare_parameter('side', 1)\nself.get_parameter('Side')", 2, "misspelt", "'side'"),
        ("ParameterNotDeclaredException", "('Invalid access to undeclared parameter(s)', 'v')", "x = self.get_parameter('v')\nself.declare_parameter('v', 1)", 1, "defined_below", "line 2"),
        ("NameError", "name 'slef' is not defined", "slef.go()", 1, "misspelt", "'self'"),
        ("NameError", "name 'Math' is not defined", "x = Math.pi", 1, "misspelt", "'math'"),
        ("NameError", "name 'car' is not defined", car(go="car.stop()"), 7, "node_is_self", "self instead of car"),
        ("NameError", "name 'pose' is not defined", HEARD.format(line="x = pose.x; t = Twist()").replace("; ", "\n        "), 7, "parameter_called", "called t"),
        ("TypeError", "Duration.__init__() got an unexpected keyword argument 'second'", car(go="Duration(second=1)"), 7, "crashed", "second"),
        ("AttributeError", "'str' object has no attribute 'executor'", "rclpy.spin('car')", 1, "spin_what", "rclpy.spin(node)"),
        ("AttributeError", "'super' object has no attribute '_init_'", "super()._init_('car')", 1, "underscores", "__init__"),
        ("ParameterNotDeclaredException", "('Invalid access to undeclared parameter(s)', 'v')", "self.declare_parameter('side', 1)\nself.get_parameter('v')", 2, "parameter_not_declared", "v"),
        ("NameError", "name 'rospy' is not defined", car(go="rospy.loginfo('go')"), 7, "ros_1_habit", "Write self.get_logger()"),
        ("AttributeError", "module 'rclpy' has no attribute 'create_publisher'", car(go="rclpy.create_publisher(Twist, '/v', 10)"), 7, "missing_self", "self.create_publisher(...)"),
        ("AttributeError", "module 'rclpy' has no attribute 'create_timer'", car(main="rclpy.create_timer(1, f)"), 10, "missing_object", "car.create_timer(...)"),
        ("AttributeError", "module 'rclpy' has no attribute 'create_timer'", "n = rclpy.create_node('a')\nrclpy.create_timer(1, f)\n", 2, "missing_object", "write n.create_timer(...)"),
        ("NameError", "name 'rospy' is not defined", car(go="rospy.get_param('v')"), 7, "ros_1_habit", "self.declare_parameter"),
        ("AttributeError", "module 'rclpy' has no attribute 'init_node'", "rclpy.init()\nnode = rclpy.init_node('a')", 2, "ros_1_habit", "Write node = rclpy.create_node('my_node')"),
        ("AttributeError", "module 'time' has no attribute 'clock'", "t = time.clock()", 1, "misspelt", "time.time()"),
        ("NameError", "name 'm' is not defined", "def f():\n    cmd = Twist()\n    pub.publish(m)\n", 3, "misspelt", "'cmd'"),
        ("NameError", "name 'm' is not defined", "def f():\n    cmd = Twist()\n    pub.publish(cmd)\n    pub.publish(m)\n", 4, "unknown_name", "m"),
        ("NameError", "name 'linear' is not defined", "def f():\n    cmd = Twist()\n    linear.x = 1.0\n", 3, "misspelt", "'cmd.linear'"),
        ("NameError", "name 'm' is not defined", "def f():\n    a, b = m, 1\n    cmd = Twist()\n    pub.publish(m)\n", 2, "unknown_name", "m"),
        ("NameError", "name 'turn' is not defined", "state = 'turn'\nif state == turn:\n    go()\n", 2, "name_without_quotes", "'turn'"),
        ("NameError", "name 'turn' is not defined", "declare_parameter('turn', 1.0)\nx = turn\n", 2, "unknown_name", "turn"),
        ("NameError", "name 'turn' is not defined", "state = 1\nif state == turn:\n    go()\n", 2, "unknown_name", "turn"),
        ("NameError", "name 'args' is not defined", "def main():\n    rclpy.init(args=args)\n", 2, "init_arguments", "def main(args=None):"),
        ("NameError", "name 'speed' is not defined", "v = 1.0  // speed in m/s\n", 1, "unknown_name", "speed"),
        ("NameError", "name 'speed' is not defined", "v = 1.0  // speed\n", 1, "c_syntax", "# (not //)"),
        ("NameError", "name 'count' is not defined", "n = 10 // count\n", 1, "unknown_name", "count"),
        ("NameError", "name 'start' is not defined", "def f():\n    start = time.time()\ndef g():\n    start + 1\n", 4, "unknown_name", "start"),
        ("NotInitializedException", "", "def main():\n    rclpy.init()\n    Car()\nCar()\n", 4, "never_called", "Nothing calls main()"),
        ("TypeError", "isinstance() arg 2 must be a type", "p = n.create_publisher(Twist(), '/v', 10)\np.publish(m)\n", 2, "wrong_order", "Line 1"),
        ("AttributeError", "'Car' object has no attribute 'k'", car(init="self.create_timer(1, self.go())\n        self.k = 0", go="self.k += 1"), 8, "callback_called_here", "behind self.go"),
        ("AttributeError", "'Car' object has no attribute 'k'", car(init="self.go()\n        self.k = 0", go="self.k += 1"), 8, "called_too_early", "line 6"),
        ("AttributeError", "'Car' object has no attribute 'f'", car(go="self.f()", more="def g(self):\n        pass\n        def f(self):\n            pass\n"), 7, "method_outside", "def g on line 8"),
        ("AttributeError", "'function' object has no attribute 'handle'", "node.create_rate(0.1, f)", 1, "unknown_in_library", "handle"),
        ("ModuleNotFoundError", "No module named 'pygame'", "import pygame", 1, "library_not_here", "pygame"),
    ],
)  # fmt: skip
def test_the_script_shows_what_is_meant(
    kind: str, message: str, source: str, line: int, code: str, words: str
) -> None:
    given, text = told(kind, message, source, line)
    assert given == code, text
    assert words in text


@pytest.mark.parametrize(
    ("name", "suggestion", "line", "code"),
    [
        ("side", "slice", "x = side / 2", "unknown_name"),
        ("size", "slice", "x = size(3)", "misspelt"),
        ("dist", "Twist", "x = dist + 1", "unknown_name"),
        ("Ture", "True", "while Ture:", "misspelt"),
        ("none", "None", "x = none", "other_language"),
        ("speeed", "speed", "x = speeed", "misspelt"),
    ],
)
def test_a_function_of_python_is_not_suggested_for_a_variable(
    name: str, suggestion: str, line: str, code: str
) -> None:
    more = f". Did you mean: '{suggestion}'?"
    assert told("NameError", f"name '{name}' is not defined", line, 1, more)[0] == code


def test_what_node_keeps_for_itself_is_not_suggested() -> None:
    message = "'Car' object has no attribute 'log'"
    assert told("AttributeError", message, car(), 7, ". Did you mean: '_log'?")[0] == "unknown_attribute"


@pytest.mark.parametrize(
    ("problem", "line", "code"),
    [
        ("invalid syntax", "self pub.publish(msg)", "missing_dot"),
        ("invalid syntax", "turn left", "syntax_error"),
        ("invalid syntax", "if x =< 3:", "reversed_sign"),
        ("invalid syntax", "self.pub->publish(msg)", "c_syntax"),
        ("invalid syntax", "msg = new Twist()", "c_syntax"),
        ("invalid syntax", "for i range(4):", "in_forgotten"),
        ("invalid syntax", "stop(self):", "def_forgotten"),
        ("invalid syntax", "super().__init__('a'):", "syntax_error"),
        ("invalid syntax", "/turtle1/cmd_vel,", "topic_without_quotes"),
        ("invalid syntax", "p = create_publisher(Twist, /cmd_vel, 10)", "topic_without_quotes"),
        ("invalid syntax", "第一步 开始", "words_in_code"),
        ("invalid syntax", "速度 = = 1", "syntax_error"),
        ("invalid character '×' (U+00D7)", "x = 2 × 3", "sign_of_maths"),
        ("f-string: expecting '}'", "print(f'{x')", "f_string"),
        ("invalid syntax", "retrun x", "misspelt_keyword"),
        ("'await' outside async function", "await asyncio.sleep(1)", "await_in_plain_function"),
        ("'await' outside function", "await f()", "outside_function"),
    ],
)
def test_what_is_told_of_a_line_that_python_rejects(problem: str, line: str, code: str) -> None:
    shown = f'  File "script.py", line 1\n    {line}\n    ^\nSyntaxError: {problem}\n'
    error = StudentError(type="SyntaxError", message=problem, line=1, traceback=shown)
    assert meaning(error, "syntax_error", ScriptText(line))[0] == code


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("AssertionError: The 'x' field must be of type 'int'", ""),
        ("AssertionError", "The 'x' field must be of type 'queer'"),
        ("TypeError: 'module' object is not callable", "x"),
        ("A\nB", "x"),
    ],
)
def test_an_exception_that_is_named_like_a_message_is_just_a_crash(kind: str, message: str) -> None:
    assert told(kind, message, "raise it", 1)[0] == "crashed"


@pytest.mark.parametrize(("between", "wanted"), [("", "copied"), ("class B:\n", "unknown_attribute")])
def test_two_functions_of_one_name_are_a_copy_only_in_one_class(between: str, wanted: str) -> None:
    source = f"class A:\n    def run(self):\n        self.turn()\n{between}    def run(self):\n        pass\n"
    assert told("AttributeError", "'A' object has no attribute 'turn'", source, 3)[0] == wanted


def test_a_property_and_its_setter_are_no_copy() -> None:
    source = (
        "class A:\n    def run(self):\n        self.turn()\n    @property\n    def v(self):\n        pass\n"
        "    @v.setter\n    def v(self, v):\n        pass\n"
    )
    assert told("AttributeError", "'A' object has no attribute 'turn'", source, 3)[0] == "unknown_attribute"


SERVICE = (
    "create_service(Trigger, 'go', on_go)\ndef on_go({given}):\n    {end}\nr = Trigger.Request\nspin()\n"
)
ANNOTATED = "request: Trigger.Request, response: Trigger.Response"


@pytest.mark.parametrize(
    ("given", "end", "wanted"),
    [
        ("request, response", "response.success = True", "no_response"),
        (ANNOTATED, "return True", "no_response"),
        (ANNOTATED, "return response", "class_for_object"),
        ("self, request, response", "return response", "class_for_object"),
        ("request, response", "return Trigger.Response(success=True)", "class_for_object"),
    ],
)
def test_a_service_that_fails_lacks_its_response_or_its_request(given: str, end: str, wanted: str) -> None:
    code, text = told("TypeError", "", SERVICE.format(given=given, end=end), 5)
    assert code == wanted
    assert wanted != "no_response" or "return response" in text


def test_a_name_of_pythons_own_is_taken_only_where_it_is_seen() -> None:
    source = "def a():\n    max = 3\ndef b():\n    return x(3) + max(1, 2)\n"
    assert told("TypeError", "'int' object is not callable", source, 4)[0] == "not_callable"
    outer = source.replace("    max", "max").replace("def a():\n", "")
    assert told("TypeError", "'int' object is not callable", outer, 3)[0] == "builtin_overwritten"


def test_a_short_name_is_a_package_of_messages_only_where_messages_are_imported() -> None:
    message = "No module named 'sensor'"
    assert told("ModuleNotFoundError", message, "import sensor", 1)[0] == "missing_module"
    assert told("ModuleNotFoundError", message, "from sensor.msg import LaserScan", 1)[0] == "misspelt"


@pytest.mark.parametrize(
    ("call", "wanted"),
    [("result()", "no_return"), ("future.result()", "still_none"), ("future()", "still_none")],
)
def test_a_method_of_something_else_is_no_function_of_the_script(call: str, wanted: str) -> None:
    source = f"def result():\n    print(1)\nr = {call}\nprint(r.success)\n"
    assert told("AttributeError", "'NoneType' object has no attribute 'success'", source, 4)[0] == wanted
