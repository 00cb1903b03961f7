"""What an exception means to a beginner, whether it ended the script or kept it from being compiled.

Type and text of an exception tell which code it gets; the sentence ``mistake.<code>`` says what it means.
"""

import builtins
import difflib
import re
from collections.abc import Callable, Mapping
from typing import Final

from grader.contracts.outcome import StudentError
from grader.contracts.text import Text
from grader.messages import enumerated, say
from grader.messages.closer import Closer, looked_closer
from grader.messages.script import LONGEST_NAME, NO_SCRIPT, Assigned, Definition, ScriptText

_AT: Final = r"\n(?:.*\n)*  File .*\n(?!(?:.*\n)*  File )"
"""Prefix of a pattern for the line that raised the exception: skips to the traceback's last ``File`` entry."""

_LINE: Final = r"(Syntax|Indentation|Tab)Error: .*\n.*\n +"
"""Prefix of a pattern for the line that Python rejects: skips to its first character."""

_SHELL: Final = (
    r"(apt|apt-get|bash|cat|cd|chmod|colcon|cp|export|git|ls|mkdir|mv|nano|pip3?|python3?|rm|ros2|sh|source|"
    r"sudo)"
)

_SIGNS: Final = (
    (_LINE + r"\d+[.:|)]?[ \t]+(?!(and|else|for|if|in|is|not|or)\b)[A-Za-z_#@\"']", "line_numbers"),
    (_LINE + rf"(\./|{_SHELL}[ \t]+(?!(and|else|for|if|in|is|not|or)\b)[^\s=(,])", "shell_line"),
    (r"SyntaxError: Missing parentheses in call to 'print'", "print_statement"),
    (r"SyntaxError: multiple exception types must be parenthesized", "except_comma"),
    (_LINE + r"<(\?xml|!DOCTYPE|html|launch|package|robot)\b", "markup_file"),
    (_LINE + r"(\}\s*)?(else[ \t]+if|elseif|elsif)\b", "else_if"),
    (_LINE + r"else[ \t]+[^:\n]+:", "else_condition"),
    (r"SyntaxError: invalid syntax\n.*\n +(?P<word>else|elif)\b.*:", "else_alone"),
    (_LINE + r"(%\w|!\w|(In|Out) ?\[\d*\] ?:)", "pasted_mark"),
    (
        _LINE + r"(//|/\*|\}|(int|void)[ \t]+main[ \t]*\(|(for|while|if)[ \t]*\([^)\n]*;|"
        r"[^\"'#\n]*(\w(::|->)\w|=[ \t]*new[ \t]+\w|\)[ \t]*\{[ \t]*\n))",
        "c_syntax",
    ),
    (r"SyntaxError: invalid decimal literal" + r".*\n.*\n.*\d\.\d*f\b", "c_syntax"),
    (_LINE + r"[^\"'#\n]*\d[ \t]*(m/s|rad/s|rad|m|s|cm|米|秒|度|弧度)(?!\w)", "unit_in_code"),
    (_LINE + r"(.*\W)?(?P<name>[A-Za-z_][\w.]*)(\+\+|--)[ \t]*[;)]?[ \t]*(#.*)?\n", "increment"),
    (r"SyntaxError: .*Maybe you meant '==' .*\n.*\n +(if|elif|while)\b", "single_equals"),
    (_LINE + r"(if|elif|while|return|\w+[ \t]*=)\b[^\"'#\n]*(&&|\|\||![\w (])", "c_operator"),
    (
        _LINE + r"(int|float|double|bool|string|String|var|let|const|auto)[ \t]+[A-Za-z_]\w*[ \t]*(=|;|\n)",
        "typed_name",
    ),
    (_LINE + r"(class|def)[ \t]+\w+[ \t]+\w+[ \t]*[(:]", "blank_in_name"),
    (_LINE + r"(?P<word>class|def)(?P<rest>\w+)[ \t]*\(.*:[ \t]*(#.*)?\n", "blank_after_word"),
    (r"SyntaxError: expression cannot contain assignment.*\n.*\n.*\w\.\w+[ \t]*=", "dotted_keyword"),
    (_LINE + r"(from|import)[ \t]+[\w.]*-", "hyphen_in_module"),
    (
        _LINE + r"(self[ \t]+(?!(and|if|in|is|not|or)\b)[A-Za-z_]|[^\"'#\n]*\)[ \t]*[A-Za-z_]\w*[ \t]*\()",
        "missing_dot",
    ),
    (_LINE + r"[^\"'#\n]*(?P<sign>=[<>])", "reversed_sign"),
    (_LINE + r"for[ \t]+(?P<name>\w+)[ \t]+range\(", "in_forgotten"),
    (_LINE + r"(?P<written>\w+[ \t]*\([ \t]*self\b[^()\n]*\)[ \t]*:)[ \t]*(#.*)?\n", "def_forgotten"),
    (
        r"SyntaxError: invalid syntax.*\n.*\n +([^\"'#\n]*[(,][ \t]*)?(?P<topic>/[A-Za-z]\w*(/\w+)*)[ \t]*[,)]",
        "topic_without_quotes",
    ),
    (r"SyntaxError: f-string: ", "f_string"),
    (r"SyntaxError: expected '\('", "def_parentheses"),
    (r"SyntaxError: expected 'except' or 'finally' block", "try_alone"),
    (r"SyntaxError: invalid syntax\. Perhaps you forgot a comma\?", "missing_comma"),
    (r"SyntaxError: expected ':'", "missing_colon"),
    (
        r"SyntaxError: ('.' was never closed|unmatched '.'|closing parenthesis '.' does not match)",
        "unbalanced",
    ),
    (r"SyntaxError: unterminated (triple-quoted )?(f-)?string literal", "open_string"),
    (r"SyntaxError: '(?P<word>await|async \w+)' outside async function", "await_in_plain_function"),
    (r"SyntaxError: '\w+' outside function", "outside_function"),
    (r"SyntaxError: invalid character '(?P<sign>[\u00b0\u00d7\u00f7\u2260\u2264\u2265])'", "sign_of_maths"),
    (r"SyntaxError: invalid (non-printable )?character", "foreign_character"),
    (
        r"SyntaxError: invalid syntax.*\n.*\n +[^\"'#=(\n]*[\u4e00-\u9fff][^\"'#=(\n]*\n",
        "words_in_code",
    ),
    (r"SyntaxError: invalid syntax\n.*\n +(```|\$ |>>> )", "pasted_mark"),
    (r"(IndentationError|TabError): ", "indentation"),
    (r"RuntimeError: Context\.init\(\) must only be called once", "init_twice"),
    (
        r"TypeError: Expected <class '[\w.]*\.(?P<wanted>\w+)'>, "
        r"got <class '(?:[\w.]*\.)?(?P<given>(?!Metaclass_)\w+)'>" + _AT + r".*\.publish\(",
        "wrong_message",
    ),
    (r"TypeError: object\.__init__\(\) takes exactly one argument", "no_base_class"),
    (
        r"ValueError: invalid literal for int\(\) with base 10: (?P<given>'\s*[-+]?(\d+\.\d*|\.\d+)\s*')",
        "int_of_decimal",
    ),
    (
        r"ValueError: (invalid literal for int\(\) with base 10|could not convert string to float): "
        r"(?P<given>.*)\n",
        "not_a_number",
    ),
    (r"UnboundLocalError: .*?'(?P<name>\w+)'", "assigned_later"),
    (r"RCLError: .*publisher's context is invalid", "shutdown_early"),
    (r"RuntimeError: Context must be initialized before it can be shutdown", "shutdown_twice"),
    (r"AttributeError: __enter__\n", "shutdown_early"),  # what `rclpy.spin()` raises without a context
    (r"InvalidHandle: cannot use Destroyable because destruction was requested", "destroyed_early"),
    (r"NameError: name 'self' is not defined", "self_outside"),
    (r"AssertionError: The '(?P<field>\w+)' field must be of type 'float'", "int_in_float"),
    (r"Aborted: field '(?P<field>\w+)' of .*`PyFloat_Check", "int_in_float_at_publish"),
    (r"Aborted: field '(?P<field>\w+)' of (?P<owner>[\w/]+): ", "wrong_type_at_publish"),
    (
        r"AssertionError: The '(?P<field>\w+)' field must be of type '(?P<type>bool|int|str)'",
        "wrong_type_in_field",
    ),
    (r"AssertionError: The '(?P<field>\w+)' field must be a set or sequence", "list_in_field"),
    (
        r"AssertionError: The '(?P<field>\w+)' field must be a sub message of type '(?P<owner>\w+)'",
        "message_in_field",
    ),
    (
        r"AttributeError: '(?P<owner>Twist|Vector3)' object has no attribute '(?P<field>\w+)'",
        "unknown_field",
    ),
    (
        r"AttributeError: '(?P<owner>\w+)_(Response|Request|Goal|Result|Feedback)' object has no attribute "
        r"'(?P<field>\w+)'",
        "unknown_part",
    ),
    (
        r"TypeError: (?P<owner>Twist|Vector3|Point|Pose|Quaternion|String|Bool|U?Int\d+|Float\d+|Time|"
        r"Duration|\w+_Request|\w+_Goal)\.__init__\(\) takes 1 positional",
        "fields_by_position",
    ),
    (r"TypeError: .*unexpected keyword argument 'queue_size'", "queue_size_of_ros_1"),
    (r"TypeError: (?!.*unexpected keyword).*qos_profile", "missing_qos"),
    (
        r"TypeError: Expected QoSProfile or int, but received <class '(str|float|bool|list|tuple)'>",
        "qos_number",
    ),
    (
        r"TypeError: float\(\) argument must be .*'(function|method)'" + _AT + r".*create_timer\(",
        "timer_order",
    ),
    (r"TypeError: (Node\.)?create_timer\(\) (missing|got an unexpected keyword)", "timer_arguments"),
    (r"TypeError: (descriptor '__init__' .*'super'|super\(\) argument 1 must be)", "super_brackets"),
    (r"ParameterAlreadyDeclaredException: ", "declared_twice"),
    (r"ParameterNotDeclaredException: .*'(?P<name>[\w.]+)'\)", "parameter_not_declared"),
    (r"ParameterUninitializedException: .*'(?P<name>[\w.]+)'", "parameter_without_value"),
    (
        r"InvalidParameterTypeException: .*parameter '(?P<name>[\w.]+)'.*'DOUBLE'.*'INTEGER'",
        "parameter_type",
    ),
    (
        r"InvalidParameterTypeException: .*parameter '(?P<name>[\w.]+)' to '(?P<given>-?\d+)' of type "
        r"'INTEGER', expecting type 'DOUBLE'",
        "parameter_integer",
    ),
    (r"InvalidParameterTypeException: .*expecting type '[\w.]*STRING'", "parameter_text"),
    (
        r"TypeError: .*'Parameter(Value)?'|AttributeError: 'Parameter(Value)?' object has no attribute",
        "parameter_value",
    ),
    (r"TypeError: Expected QoSProfile or int, but received <class '(function|method)'>", "wrong_order"),
    (r"TypeError: Publisher\.publish\(\) (takes|missing) ", "one_message"),
    (r"TypeError: spin(_once|_until_future_complete)?\(\) missing .*'node'", "spin_what"),
    (r"AttributeError: 'str' object has no attribute 'executor'", "spin_what"),
    (r"TypeError: spin_until_future_complete\(\) missing .*'future'", "future_missing"),
    (r"TypeError: spin(_once)?\(\) got an unexpected keyword argument 'time", "spin_timeout"),
    (r"AttributeError: '(int|float)' object has no attribute '(add|remove)_node'", "spin_timeout"),
    (r"TypeError: \w*Executor\.spin\w*\(\) takes 1 positional", "executor_spin"),
    (
        r"TypeError: 'str' object cannot be interpreted as an integer" + _AT + r".*\bsleep\([ \t]*['\"]",
        "text_in_sleep",
    ),
    (
        r"TypeError: 'str' object cannot be interpreted as an integer" + _AT + r".*\bsleep\(",
        "text_for_number",
    ),
    (r"TypeError: '(float|str)' object cannot be interpreted as an integer", "whole_number"),
    (r"RecursionError: ", "recursion"),
    (r"TypeError: rclpy_resolve_name\(\)", "wrong_order"),
    (r"TypeError: isinstance\(\) arg 2 must be a type.*" + _AT + r".*\.publish\(", "wrong_order"),
    (r"AttributeError: type object '\w+' has no attribute '_TYPE_SUPPORT'", "wrong_order"),
    (
        r"TypeError: '(function|method)' object is not subscriptable" + _AT + r".*\bcreate_\w+\(",
        "wrong_order",
    ),
    (
        r"TypeError: (type '\w+'|'(builtin_function_or_method|function|method|type)' object) "
        r"is not subscriptable",
        "square_brackets",
    ),
    (
        r"TypeError: ('[<>]=?' not supported|unsupported operand) .*"
        r"('Time' and '(int|float)'|'(int|float)' and 'Time')",
        "time_and_number",
    ),
    (
        r"TypeError: ('[<>]=?' not supported|unsupported operand) .*"
        r"('Duration' and '(int|float)'|'(int|float)' and 'Duration')",
        "duration_and_number",
    ),
    (r"TypeError: ('[<>]=?' not supported|unsupported operand) .*'array\.array'", "whole_array"),
    (r"TypeError: .* argument after \* must be an iterable", "comma_of_args"),
    (r"TypeError: unsupported operand .*'tuple'", "comma_at_end"),
    (
        r"TypeError: (unsupported operand .*'NoneType'|'[<>]=?' not supported .*'NoneType'|"
        r"must be real number, not NoneType)",
        "none_in_sum",
    ),
    (r"TypeError: (rclpy_logging_rcutils_log|RcutilsLogger\.\w+)\(\)", "log_not_text"),
    (
        r"TypeError: Node\.__init__\(\) missing 1 required keyword-only argument: 'executable'",
        "launch_no_executable",
    ),
    (r"TypeError: Node\.__init__\(\) missing", "no_super_init"),
    (r"TypeError: create_node\(\) missing .*'node_name'", "no_node_name"),
    (r"TypeError: init\(\) takes 0 positional.*" + _AT + r".*\brclpy\.init\(", "init_arguments"),
    (r"TypeError: Node\.__init__\(\) (takes 2 positional|got an unexpected keyword)", "node_name_only"),
    (
        r"AttributeError: '\w+' object has no attribute '(_(clock|default_callback_group|logger|parameters|"
        r"parameter_overrides|publishers|rate_group|Node__\w+))'(?!.*" + _AT + r".*\.\1\b)",
        "no_super_init",
    ),
    (
        r"Invalid(Node|Topic|Service)NameException: |InvalidNamespaceException: |"
        r"ValueError: Failed to create action (client: failed to get goal service|\w+ due to invalid topic) name",
        "bad_name",
    ),
    (r"TypeError: 'NoneType' object is not callable", "callback_called"),
    (r"(Attribute|Type)Error: 'property' object ", "class_for_object"),
    (r"TypeError: \w+\.\w+\(\) missing 1 required positional argument: 'self'", "class_for_object"),
    (
        r"TypeError: '(Vector3|Twist)' object (does not support item assignment|is not subscriptable)",
        "vector_index",
    ),
    (
        r"TypeError: ('(int|float|bool)' object is not iterable|Failed to normalize given item of type )"
        r"(.*\n)*  File \"[^\"\n]*launch\.py\".*\n(?! *for\b)(?!(?:.*\n)*  File )",
        "launch_number",
    ),
    (r"TypeError: 'TimerAction' expected 'period' .*'<class 'int'>'", "launch_period"),
    (
        r"TypeError: Action\.__init__\(\) got an unexpected keyword argument '(?P<name>\w+)'",
        "launch_keyword",
    ),
    (
        r"SubstitutionFailure: executable '(?P<name>[^'\n]*)' not found on the libexec",
        "launch_executable",
    ),
    (
        r"PackageNotFoundError: (\"package )?\W*(?P<name>[^'\n]*)' (not found, searching|is not a valid package)",
        "unknown_package",
    ),
    (r"InvalidPythonLaunchFileError: .* returns None, no LaunchDescription", "launch_returns_nothing"),
    (
        r"TypeError: '(int|float)' object is not iterable(?!.*" + _AT + r"(?!.*\b(for|list|tuple|sum)\b))",
        "not_iterable",
    ),
    (r"TypeError: float\(\) argument must be .* not 'list'", "list_for_number"),
    (r"TypeError: '(int|float)' object is not subscriptable", "number_index"),
    (r"TypeError: Expected .*, got <class '[\w.]*\.Metaclass_\w+'>", "class_for_object"),
    (
        r"TypeError: (?!(Node|Client|Publisher|ActionClient|Executor|Rate|Clock)\.)(\w+\.)?\w+\(\) "
        r"(takes \d+ positional arguments? but|missing \d+ required positional)",
        "wrong_parameters",
    ),
    (
        r"TypeError: ([\w.]+\.)?(?P<name>\w+)\(\) got an unexpected keyword argument '(?P<given>\w+)'",
        "keyword_of_own",
    ),
    (r"TypeError: ([\w.]+\.)?(<locals>\.)?<lambda>\(\) (takes|missing) ", "lambda_parameters"),
    (r"TypeError: 'module' object is not callable", "module_called"),
    (r"TypeError: '(?!type)\w+' object is not callable", "not_callable"),
    (r"TypeError: 'NoneType' object does not support the context manager protocol", "with_init"),
    (
        r"(AttributeError: (?=')|TypeError: (?!.*(keyword|positional) argument))"
        r"(?:(?! attribute ).)*['\"](builtin_function_or_method|function|method)['\"]",
        "function_not_called",
    ),
    (
        r"TypeError: (unsupported operand .*'str'|can only concatenate str|can't multiply sequence by|"
        r"'[<>]=?' not supported .*'str'|must be real number, not str)",
        "text_for_number",
    ),
    (r"TypeError: \n", "no_request"),  # what a service's server raises at home, without a word
    (r"AttributeError: 'NoneType' object has no attribute ", "still_none"),
    (
        r"AttributeError: property '(?P<name>clients|context|default_callback_group|guards|handle|publishers|"
        r"services|subscriptions|timers|waitables)' of '\w+' object has no setter",
        "name_taken",
    ),
    (r"AttributeError: 'super' object has no attribute '_*init_*'", "underscores"),
    (r"AttributeError: ", "unknown_attribute"),
    (r"NameError: name '(?P<name>__main__)' is not defined", "name_without_quotes"),
    (r"NameError: name '(?=(\w*_){2})_{0,3}(name|main|init)_{0,3}' is not defined", "underscores"),
    (r"NameError: name '(?P<name>\w*[\u4e00-\u9fff]\w*)' is not defined", "words_in_code"),
    (r"NameError: ", "unknown_name"),
    (r"KeyError: ", "missing_key"),
    (r"ZeroDivisionError: ", "divided_by_zero"),
    (r"NotImplementedError: Service classes can not be instantiated", "service_class"),
    (r"NotImplementedError: Action classes can not be instantiated", "action_class"),
    (r"ValueError: math domain error", "math_domain"),
    (r"TypeError: unsupported operand type\(s\) for \^: '(float|int)'", "power_sign"),
    (r"TypeError: atan2 expected 2 arguments, got 1", "atan2_of_one"),
    (r"TypeError: unsupported operand type\(s\) for .*'property'", "field_of_class"),
    (r"ModuleNotFoundError: No module named '(rospy|roslib|rosbag|roslaunch)\b", "ros_1"),
    (
        r"ModuleNotFoundError: No module named '(getch|keyboard|msvcrt|pygame|pynput|readchar)\b",
        "no_terminal",
    ),
    (r"(ModuleNotFound|Import)Error: ", "missing_module"),
    (r"NotInitializedException: ", "not_initialized"),
    (r"EOFError: ", "no_input"),
    (r"IndexError: list index out of range" + _AT + r".*\bsys\.argv\[", "no_arguments"),
    (r"IndexError: array index out of range" + _AT + r".*\branges\[", "ranges_index"),
    (
        r"IndexError: pop from (an )?empty (list|deque)" + _AT + r".*?(?P<list>[\w.]{1,60})\.pop(left)?\(",
        "list_empty",
    ),
    (r"IndexError: (array|list|string|tuple) index out of range", "index_range"),
    (r"error: Cannot load (URDF|SDF|MJCF) file", "urdf_not_found"),
    (r"error: Not connected to physics server", "bullet_not_connected"),
    (r"error: (\(25, |setupterm:)", "no_terminal"),  # of termios and curses
    (r"TclError: ", "no_display"),
    (r"FileNotFoundError: ", "missing_file"),
    (r"OSError: \[Errno 28\]", "disk_full"),
    (r"OperationalError: unable to open database file", "no_real_file"),
    (r"OSError: \[Errno 9\] .*\n(.*\n)*.*(mmap|tofile|fromfile)", "no_real_file"),
)
"""Patterns of the beginning of ``Type: message``, behind which the traceback follows, and their codes.

The first pattern that fits counts, so a special one stands before a general one of the same type. `re` compiles
each when it is first tried: all of them take 15 ms, and most scripts raise nothing.
"""


_LONGEST: Final = 200
_MODULE_PATH: Final = re.compile(r" \(/\S+\)$")
_SUGGESTION: Final = re.compile(r"\. Did you mean: '(\w+)'\?\s*$")
_WITHOUT_WORDS: Final = Text(zh="没有更多说明", en="without a word")

_NAMES_BY_MODULE: Final = {
    "geometry_msgs.msg": ("Point", "PoseStamped", "Quaternion", "Twist", "TwistStamped", "Vector3"),
    "nav_msgs.msg": ("Odometry", "Path"),
    "sensor_msgs.msg": ("Image", "Imu", "LaserScan"),
    "std_msgs.msg": ("Bool", "Float32", "Float64", "Int32", "String"),
    "std_srvs.srv": ("Empty", "SetBool", "Trigger"),
    "rosclaw_msgs.srv": ("CallService", "GetCapabilities", "PublishMessage"),
    "turtlesim.msg": ("Color", "Pose"),
    "turtlesim.srv": ("Kill", "SetPen", "Spawn", "TeleportAbsolute", "TeleportRelative"),
    "rclpy.action": ("ActionClient", "ActionServer"),
    "rclpy.duration": ("Duration",),
    "rclpy.executors": ("MultiThreadedExecutor", "SingleThreadedExecutor"),
    "rclpy.node": ("Node",),
    "rclpy.parameter": ("Parameter",),
    "rclpy.qos": ("QoSProfile", "qos_profile_sensor_data"),
    "math": ("atan2", "cos", "degrees", "pi", "radians", "sin", "sqrt"),
    "time": ("sleep",),
    "threading": ("Thread",),
}
_IMPORTS: Final = (
    {name: f"from {module} import {name}" for module, names in _NAMES_BY_MODULE.items() for name in names}
    | {
        name: f"import {name}"
        for name in (
            "argparse",
            "asyncio",
            "json",
            "math",
            "os",
            "random",
            "rclpy",
            "sys",
            "threading",
            "time",
        )
    }
    | {"np": "import numpy as np", "numpy": "import numpy"}
)
_MODULES: Final = tuple(dict.fromkeys((
    *_NAMES_BY_MODULE, "geometry_msgs", "nav_msgs", "numpy", "random", "rclpy", "sensor_msgs", "std_msgs",
    "std_srvs", "sys", "threading", "turtlesim", "argparse", "asyncio", "collections", "datetime", "json",
    "typing",
)))  # fmt: skip
_LIBRARIES_NOT_HERE: Final = frozenset((
    "PIL", "RPi", "bs4", "cv2", "cv_bridge", "flask", "gazebo_msgs", "gym",
    "gymnasium", "imageio", "moveit_msgs", "nav2_simple_commander", "open3d",
    "openai", "pandas", "psutil", "pybullet", "pybullet_data", "requests", "scipy", "seaborn", "serial",
    "skimage", "sklearn", "smbus", "spidev", "sympy", "tensorflow", "torch", "torchvision", "tqdm",
    "transforms3d", "ultralytics", "usb", "yolov5",
))  # fmt: skip
"""Libraries that a beginner's PC may have and that the sandbox has not."""

_NODE_ATTRIBUTES: Final = (
    "create_client", "create_publisher", "create_rate", "create_service", "create_subscription", "create_timer",
    "declare_parameter", "destroy_node", "get_clock", "get_logger", "get_name", "get_parameter",
    "handle",
)  # fmt: skip
"""Attributes of Node that beginners use, or that `rclpy.spin` uses for them."""

_NODE_LISTS: Final = ("clients", "guards", "publishers", "services", "subscriptions", "timers", "waitables")
"""Python suggests these for `self.publisher` and the like, but the student meant a variable of their own."""

_NODE_PROPERTIES: Final = tuple(sorted((*_NODE_LISTS, "context", "default_callback_group", "handle")))
"""Attributes of Node that break it if a method of the student's class takes their name."""

_NODE_METHODS: Final = (
    "create_client", "create_publisher", "create_service", "create_subscription", "create_timer",
    "declare_parameter", "declare_parameters", "get_clock", "get_logger", "get_parameter", "has_parameter",
    "set_parameters",
)  # fmt: skip
"""Methods of Node that it calls itself, or that a method of the student's class means to call by its own name."""


def suggested(error: StudentError) -> str | None:
    """Return the name that Python suggests instead of an unknown one; None if it suggests none."""
    found = _SUGGESTION.search(error.traceback)
    return None if found is None or re.match(r"_(?!_)", found[1]) else found[1]


def meaning(error: StudentError, otherwise: str, script: ScriptText = NO_SCRIPT) -> tuple[str, Text]:
    """Return the code of the mistake behind an exception, and the sentence that explains it.

    Args:
        error: the exception.
        otherwise: the code if nothing more precise is known.
        script: the script that raised the exception.
    """
    # long lines make patterns slow
    shown = "\n".join(line[:_LONGEST] for line in error.traceback.split("\n"))
    # A script may name its exceptions as it likes; only a plain name is one that the signs know.
    kind = error.type if re.fullmatch(r"[\w.]+", error.type) else "Exception"
    told = f"{kind}: {error.message}\n{shown}"
    known = ((code, re.match(sign, told)) for sign, code in _SIGNS)
    code, values = next(((code, found.groupdict()) for code, found in known if found), (otherwise, {}))
    refine = _REFINED.get(code)
    closer = None if refine is None else refine(error, script)
    if closer is not None:
        code, values = closer
    if (cause := looked_closer(code, error, script_line(error), script)) is not None:
        code, values = cause
    values = {name: "" if value is None else value for name, value in values.items()}
    problem = _first_line(error.message) or _WITHOUT_WORDS
    if code == "crashed" and error.line is None:
        return code, say("exception.outside", type=error.type, problem=problem)
    return code, say(
        f"mistake.{code}", **{"line": error.line or "?", "type": error.type, "problem": problem, **values}
    )


_OTHER_LANGUAGES: Final = {
    "this": "self",
    "raw_input": "input()",
    "xrange": "range()",
    "unicode": "str()",
    "cout": "print()",
    "printf": "print()",
    "RCLCPP_INFO": "self.get_logger().info('...')",
    "ROS_INFO": "self.get_logger().info('...')",
    "true": "True",
    "false": "False",
    "null": "None",
    "NULL": "None",
    "nullptr": "None",
    "nil": "None",
    "none": "None",
}
"""Names of Python 2, C++ and other languages, each with what Python 3 has instead."""

_OF_ROS_1: Final = {
    "Rate": "time.sleep(0.1)",
    "Publisher": "node.create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "Subscriber": "node.create_subscription(Pose, '/turtle1/pose', callback, 10)",
    "init_node": "rclpy.init(); node = rclpy.create_node('my_node')",
    "is_shutdown": "not rclpy.ok()",
    "loginfo": "node.get_logger().info('...')",
    "sleep": "time.sleep(0.1)",
    "Time": "node.get_clock().now()",
    "create_publisher": "node.create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "create_timer": "node.create_timer(0.1, callback)",
    "Service": "node.create_service(SetBool, '/my_service', callback)",
    "ServiceProxy": "node.create_client(Spawn, '/spawn')",
    "Timer": "node.create_timer(0.1, callback)",
    "get_param": "node.declare_parameter('side', 2.0).value",
    "get_logger": "node.get_logger()",
}
"""Attributes that ``rclpy`` does not have, each with what to write instead."""

_STATEMENTS: Final = (
    "break", "class", "continue", "def", "elif", "else", "except", "finally", "for", "from", "global", "if",
    "import", "pass", "raise", "return", "try", "while", "with",
)  # fmt: skip


def _statement(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a line that Python does not take: its first word may be a misspelt one of Python's."""
    if (above := _without_comma(error, script)) is not None:
        return "missing_comma", {"line": above}
    found = re.match(r"([A-Za-z]+)(?=[ \t]+[A-Za-z_(\"']|[ \t]*:)", script_line(error))
    if found is None or found[1] in _STATEMENTS:
        return None
    name = found[1]
    same = [known for known in _STATEMENTS if sorted(known) == sorted(name.lower())]
    alike = [known for known in _STATEMENTS if known[0] == name[0].lower()]
    near = same or difflib.get_close_matches(name.lower(), alike, 1, _NEAR)
    return ("misspelt_keyword", {"name": name, "suggestion": near[0]}) if near else None


def _without_comma(error: StudentError, script: ScriptText) -> int | None:
    """Return the line of an argument that another one follows, each on a line of its own, without a comma."""
    above = (error.line or 0) - 1
    if not 0 < above < len(script.lines):
        return None
    before, behind = script.lines[above - 1].strip(), script.lines[above].strip()
    is_argument = re.fullmatch(r"[\w.]+|\"\"", before) and before not in _STATEMENTS
    return above if is_argument and re.match(r"([\w.]+|\"\") ?,", behind) else None


def _pasted(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a foreign character: prose around code that was copied from a web page has many."""
    fences = script.lines_with(r"^[ \t]*```")
    if fences:
        return "pasted_mark", {"line": fences[0]}
    return ("prose", {}) if _PROSE.fullmatch(script_line(error)) else None


_PROSE: Final = re.compile(r"(?=(?:[^\u4e00-\u9fff]*[\u4e00-\u9fff]){4})[\w\u3000-\u303f\uff01-\uff1f /.+-]+")
"""A line of words and their punctuation, without the brackets, quotes and signs of code."""


def _float(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a value that was assigned to a field of type float and is none."""
    given = script_line(error).partition("=")[2].partition("#")[0].strip()
    field = re.match(r"The '(\w+)'", error.message)
    if field is not None and given[:1] in ("'", '"'):
        return "text_in_float", {"field": field[1]}
    return ("comma_in_float", {}) if re.match(r"-?\d+[ \t]*,[ \t]*\d+$", given) else None


def _later(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a variable without a value: it may have the name of what it is made from."""
    found = re.search(r"'(\w+)'", error.message)
    name = "" if found is None else found[1]
    if name and script.lines_with(rf"^[ \t]*import[ \t]+{name}$"):
        return "hidden_module", {"name": name}
    return ("name_hides_class", {"name": name}) if name in _IMPORTS and name[:1].isupper() else None


_DURATION_OF_ROS_1: Final = {
    "to_sec": ".nanoseconds / 1e9",
    "to_nsec": ".nanoseconds",
    "secs": ".nanoseconds / 1e9",
    "nsecs": ".nanoseconds",
    "seconds": ".nanoseconds / 1e9",
}
"""Attributes of times and durations in ROS 1, each with what ROS 2 has instead."""


def _comma(error: StudentError, script: ScriptText) -> Closer:
    """Look for the comma that made a tuple of a number."""
    lines = [
        number
        for number in script.lines_with(r"=[ \t]*-?[\d.]+[ \t]*,[ \t]*$")
        if number == 1
        or not re.search(r"[(\[{,][ \t]*$", script.lines[number - 2])  # then it separates arguments
    ]
    return ("comma_at_end", {"line": lines[0]}) if lines else ("crashed", {})


def _text(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at text in a computation: it may be a parameter's default."""
    lines = script.numbers_as_text
    if not lines and "multiply sequence" in error.message and not script.lines_with(r"\binput\(|\bargv\b"):
        return "sequence_times_number", {}
    return ("parameter_text", {"line": lines[0]}) if lines else None


_SIGNS_OF_MATHS: Final = {"×": "*", "÷": "/", "≤": "<=", "≥": ">=", "≠": "!=", "°": "math.radians(90)"}
_OF_TYPE: Final = {"bool": "True", "int": "int(x)", "str": "str(x)"}
_CALLS_OF_MODULES: Final = {"time": "time.time()", "random": "random.random()", "math": "math.sqrt(x)"}


def _sign(error: StudentError, script: ScriptText) -> Closer:
    sign = error.message.partition("'")[2][:1]
    return "sign_of_maths", {"sign": sign, "instead": _SIGNS_OF_MATHS.get(sign, "")}


def _reversed(error: StudentError, script: ScriptText) -> Closer:
    found = re.search(r"=([<>])", script_line(error))
    return ("reversed_sign", {"sign": found[0], "instead": f"{found[1]}="}) if found else ("syntax_error", {})


def _field_type(error: StudentError, script: ScriptText) -> Closer:
    found = re.search(r"'(\w+)' field must be of type '(\w+)'", error.message)
    if found is None or found[2] not in _OF_TYPE:
        return "crashed", {}
    return "wrong_type_in_field", {"field": found[1], "instead": _OF_TYPE[found[2]], "wanted": found[2]}


def _module_called(error: StudentError, script: ScriptText) -> Closer:
    """Name the module that is called, if only one can be meant."""
    called = set(re.findall(r"(?<![\w.])(\w+)[ \t]*\(", script_line(error)[:_LONGEST]))
    imported = {
        name for _, found in script.matches(r"\bimport ([\w, ]+)") for name in re.findall(r"\w+", found[1])
    }
    known = sorted(called & imported)
    if len(known) != 1:
        return "crashed", {}
    return "module_called", {"name": known[0], "instead": _CALLS_OF_MODULES.get(known[0], f"{known[0]}.…()")}


def _keyword(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an argument whose name a function of the script does not have."""
    found = re.match(r"(?:[\w.]*?(\w+)\.)?(\w+)\(\) .*'(\w+)'", error.message)
    made = script.definition(found[2]) if found else None
    owner = None if found is None or not found[1] else script.class_line(found[1])
    if found is not None and _is_of_node(found[1], found[2], script):
        return "name_taken", {"name": found[2]}
    if found is None or made is None or (found[1] and owner is None):
        return "crashed", {}
    return "keyword_of_own", {"name": found[2], "given": found[3], "begins": made.line}


def _words(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at Chinese words in code, which some take for the names of variables."""
    named = script.lines_with(r"^[ \t]*(self\.)?\w*[\u4e00-\u9fff]\w* ?=(?!=)")
    if not named:
        return "words_in_code", {}
    return ("unknown_name" if error.type == "NameError" else "syntax_error"), {}


def _asked_again(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a missing input: the script may have asked again because `int()` refused the first one."""
    lines = script.lines_with(r"\bint\([ \t]*input\(")
    refused = script.lines_with(r"\bexcept( ?:|\b.*\b(ValueError|Exception)\b)")
    return ("int_asks_again", {"asked": lines[0]}) if lines and refused else None


def _not_started(error: StudentError, script: ScriptText) -> Closer:
    lines = script.lines_with(r"^[ \t]*rclpy\.init$")
    return ("only_named", {"line": lines[0], "call": "rclpy.init()"}) if lines else None


def _function(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a function used as a value: a method may have taken the place of one of Node's own."""
    if re.search(r"\btime\.\w+", script_line(error)) and script.lines_with(
        r"from time import\b.*(\btime\b|\*)"
    ):
        return "time_is_function", {}
    taken = script.methods(_NODE_PROPERTIES)
    looked_at = r"super\(\)|\bspin|\badd_node\(" if "not iterable" in error.message else r"super\(\)"
    return ("name_taken", {"name": taken[0]}) if taken and re.search(looked_at, script_line(error)) else None


def _is_of_node(owner: str | None, name: str, script: ScriptText) -> bool:
    """Whether a class of the script, a node it seems, has a method under the name of one of Node's."""
    made = script.definition(name) if owner and name in _NODE_METHODS else None
    return made is not None and made.takes_self and not script.class_without_base(owner or "")


def _parameters(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a call with the wrong number of arguments: the caller may be wrong, or the function."""
    found = re.match(r"(?:\w+\.)?(\w+)\(\) ", error.message)
    name = "" if found is None else found[1]
    made = script.definition(name)
    if made is not None and script.hands_over(error.line or 0, name):
        return "callback_called", {}
    if _is_of_node(error.message.rpartition("()")[0].rpartition(".")[0], name, script):
        return "name_taken", {"name": name}
    owner = re.match(r"(\w+)\.__init__\(\)", error.message)
    if made is not None and made.takes_self and owner is not None and f"{owner[1]}(" in script_line(error):
        return "init_mismatch", {"name": owner[1], "begins": made.line}
    is_method = re.match(r"\w+\.", error.message) is not None
    if made is None or (is_method and not made.takes_self) or f"{name}(" not in script_line(error):
        return None if is_method else ("crashed", {})
    return "call_mismatch", {"name": name, "begins": made.line}


def _name(error: StudentError) -> Closer:
    """Look closer at an unknown name."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    if found is None:
        return None
    name = found[1]
    written = script_line(error)
    if re.fullmatch(_SHELL, name) and re.match(rf"{_SHELL}([ \t]+[-~/.\w].*)?$", written):
        return "shell_line", {}
    if name in {"name", "main"} and re.match(r"if\b", written):
        return "underscores", {}
    if name == "rospy":
        used = re.search(r"\brospy\.(\w+)", written)
        instead = _OF_ROS_1.get(used[1] if used else "", "rclpy")
        return "ros_1_habit", {"name": used[0] if used else name, "instead": instead}
    if name in _OTHER_LANGUAGES:
        return "other_language", {"name": name, "instead": _OTHER_LANGUAGES[name]}
    if name in _IMPORTS:
        return "missing_import", {"name": name, "statement": _IMPORTS[name]}
    if (near := _respelt(name, written)) is not None:
        return "misspelt", {"suggestion": near}
    suggestion = suggested(error)
    if suggestion is None:
        return None
    is_called = re.search(rf"\b{name}[ \t]*\(", written) is not None
    if not is_called and suggestion not in ("True", "False", "None") and _is_function(suggestion, name):
        return None  # `node`, which nobody made, is not the class `Node`, nor `size` the function `slice`
    return "misspelt", {"suggestion": suggestion}


_WORDS: Final = ("self", "True", "False", "None", "break", "continue", "pass", "return")
"""Words of Python, for which it suggests nothing where letters changed places."""


def _respelt(name: str, written: str) -> str | None:
    """Return the module, or the word of Python, that is written with other capitals or its letters exchanged."""
    if _IMPORTS.get(name.lower(), "").startswith("import ") and re.search(rf"\b{name}\.", written):
        return name.lower()
    return next((known for known in _WORDS if sorted(known) == sorted(name)), None)


def _is_function(suggestion: str, name: str) -> bool:
    """Whether Python suggests one of its own functions, or a class for the name of a variable."""
    return hasattr(builtins, suggestion) or (suggestion[:1].isupper() and name.islower())


def _own_name(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an unknown name that may be a method of the student's own class."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    if found is None:
        return None
    name, line, written = found[1], error.line or 0, script_line(error)
    if re.search(rf"({_NAMING})\([ \t]*{name}[ \t]*[,)]", written):
        return "name_without_quotes", {"name": name}
    node = script.object_at(line)
    made = script.definition(name)
    if made is not None and made.takes_self:
        called = re.search(rf"\b{name}[ \t]*\(", written) is not None
        values = {"name": name, "call": "(...)" if called else ""}
        return ("missing_self", values) if node == "self" else ("missing_object", {**values, "object": node})
    if made is not None and script.owner_of(made.line) is not None:
        return "function_inside", {"name": name, "begins": made.line}
    if name in _NODE_ATTRIBUTES and script.in_method(line):
        return "missing_self", {"name": name, "call": "(...)"}
    if (given := _assigned_in_class(name, script)) and line not in given:
        if node != "self":
            return "missing_object", {"name": name, "object": node, "call": ""}
        return "missing_self_value", {"name": name, "given": given[0]}
    if (local := script.assigned(name)) is not None and (
        closer := _of_other(local, line, script)
    ) is not None:
        return closer
    if script.node_class and name not in _OTHER_LANGUAGES and _is_node(name, written):
        return "node_not_made", {"name": name, "owner": script.node_class}
    return _nearest_own(name, line, script, _name(error))


_NAMING: Final = r"\b__init__|\bNode|\bcreate_node|\b(?:get|declare|has)_parameter"
"""Calls whose first argument is a name, which is text."""


def _assigned_in_class(name: str, script: ScriptText) -> list[int]:
    """Return the lines that assign an attribute: ``self.name = ...``, or ``name = ...`` in the class itself."""
    own = script.lines_with(rf"\bself\.{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    plain = script.lines_with(rf"^[ \t]+{re.escape(name)} ?(:[^=]*)?=(?!=)")
    owners = ((number, script.owner_of(number)) for number in plain)
    return own or [n for n, above in owners if above and re.match(r"[ \t]*class\b", script.lines[above - 1])]


def _nearest_own(name: str, line: int, script: ScriptText, otherwise: Closer) -> Closer:
    """Prefer a similar function or class of the script, not defined yet when it failed, to Python's suggestion."""
    if otherwise is not None and otherwise[0] != "misspelt":
        return otherwise
    if not script.is_short or len(name) > LONGEST_NAME:
        return otherwise
    if script.publisher and re.search(
        rf"(?<![\w.]){name}\.publish\(", "".join(script.lines[line - 1 : line])
    ):
        return "misspelt", {"suggestion": script.publisher}
    if name in script.defined_names:
        begins = script.lines_with(rf"^(def|class) {name}\b")[-1]
        return ("defined_below", {"name": name, "begins": begins}) if begins > line else None
    near = difflib.get_close_matches(name, script.defined_names, 1, _NEAR)
    return ("misspelt", {"suggestion": near[0]}) if near else otherwise


_NEAR: Final = 0.75


def _of_other(local: Assigned, line: int, script: ScriptText) -> Closer:
    """Look at a name that another function than the one around `line` assigns."""
    around = script.function_around(local.line), script.function_around(line)
    if not all(around) or around[0] == around[1]:
        return None
    if script.in_method(line) and local.value.startswith(f"{script.node_class}("):
        return "node_is_self", {"name": local.name, "given": local.line}
    both = script.in_method(line) and script.in_method(local.line)
    code = "local_of_method" if both else "local_of_function"
    return code, {"name": local.name, "given": local.line, "function": around[0]}


def _is_node(name: str, written: str) -> bool:
    """Whether the line takes what `name` stands for to be a node."""
    return (
        re.search(rf"\bspin\w*\([ \t]*{name}\b|\b{name}\.(destroy_node|get_\w+|create_\w+)\(", written)
        is not None
    )


def _attribute(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an unknown attribute."""
    found = re.match(r"'(\w+)' object has no attribute '(\w+)'", error.message)
    closer = _of_module(error, script) if found is None else _of_object(found[1], found[2], error, script)
    if closer is not None:
        return closer
    suggestion = suggested(error)
    if suggestion is not None and suggestion not in _NODE_LISTS:
        return "misspelt", {"suggestion": suggestion}
    if found is not None and (closer := _message_fields(found[1], found[2], script)) is not None:
        return closer
    own = found is not None and script.class_line(found[1]) is not None
    return None if own or not script.has_code else ("unknown_in_library", {})


def _of_module(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at what a module has not."""
    if error.message == "type object 'Time' has no attribute 'now'":
        return "ros_1_habit", {
            "name": "Time.now()",
            "instead": f"{script.object_at(error.line or 0)}.get_clock().now()",
        }
    found = re.match(r"module '(\w+)' has no attribute '(\w+)'", error.message)
    if found is None:
        return None
    module, name = found.groups()
    if (module, name) == ("time", "now"):
        return "misspelt", {"suggestion": "time.time()"}
    if module == "rclpy" and name in _OF_ROS_1:
        return "ros_1_habit", {"name": f"rclpy.{name}", "instead": _OF_ROS_1[name]}
    if module == "rclpy" and _IMPORTS.get(name, "").startswith("from rclpy."):
        return "not_in_module", {"name": name, "statement": _IMPORTS[name]}
    if name in ("msg", "srv", "action") or f"{module}.{name}" in _MODULES:
        return "import_statement", {"statement": f"import {module}.{name}"}
    return None


def _of_object(owner: str, name: str, error: StudentError, script: ScriptText) -> Closer:
    """Look closer at what an object has not."""
    is_node = owner in ("Node", script.node_class)
    if name in ("spin", "spin_once") and is_node:
        return "spin_of_rclpy", {"name": name}
    if is_node and name in _NODE_OF_ROS_1:
        node = script.object_at(error.line or 0)
        return "ros_1_habit", {"name": f"{node}.{name}", "instead": f"{node}.{_NODE_OF_ROS_1[name]}"}
    if owner in ("Duration", "Time") and name in _DURATION_OF_ROS_1:
        return "ros_1_habit", {"name": f".{name}", "instead": _DURATION_OF_ROS_1[name]}
    closer = _own_attribute(owner, name, script)
    if closer is None and is_node and name in _MEANT_OF_NODE:
        return "misspelt", {"suggestion": _MEANT_OF_NODE[name]}
    return closer or _of_an_object(name, script_line(error), script)


_NODE_OF_ROS_1: Final = {
    "advertise": "create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "subscribe": "create_subscription(Pose, '/turtle1/pose', callback, 10)",
    "get_param": "declare_parameter('side', 2.0).value",
    "loginfo": "get_logger().info('...')",
    "logwarn": "get_logger().warning('...')",
    "logerr": "get_logger().error('...')",
}
"""What a node had in ROS 1, or what ``rospy`` had, each with what a node of ROS 2 has."""

_MEANT_OF_NODE: Final = {
    "create_sub": "create_subscription",
    "create_subscriber": "create_subscription",
    "create_pub": "create_publisher",
    "logger": "get_logger()",
    "clock": "get_clock()",
    "get_time": "get_clock().now()",
    "now": "get_clock().now()",
}
"""What Node does not have under these names, for which Python suggests something far from it."""

_FIELDS: Final = {
    "Odometry": "pose.pose.position (x, y, z), pose.pose.orientation, twist.twist (linear, angular)",
    "PoseWithCovariance": "pose.position (x, y, z), pose.orientation (x, y, z, w)",
    "TwistWithCovariance": "twist.linear (x, y, z), twist.angular (x, y, z)",
    "LaserScan": "ranges, angle_min, angle_max, angle_increment, range_min, range_max",
}
"""The fields of the messages that beginners read."""

_FIELDS_OF_POSE: Final = {
    "turtlesim": "x, y, theta, linear_velocity, angular_velocity",
    "geometry_msgs": "position (x, y, z), orientation (x, y, z, w)",
}


def _message_fields(kind: str, name: str, script: ScriptText) -> Closer:
    """Return the fields that a message has, instead of the one that was named."""
    fields = _FIELDS.get(kind)
    if kind == "Pose":
        packages = [one for one in _FIELDS_OF_POSE if script.lines_with(rf"\b{one}\.msg import\b.*\bPose\b")]
        fields = _FIELDS_OF_POSE[packages[0]] if len(packages) == 1 else None
    return None if fields is None else ("message_fields", {"type": kind, "name": name, "fields": fields})


def _of_an_object(name: str, written: str, script: ScriptText) -> Closer:
    """Look at how the attribute was used: to publish, or on a variable that hides a module of the same name."""
    if name == "publish":
        return "no_publisher_object", {"publisher": script.publisher or "self.pub"}
    own = script.publisher or ""
    if own.startswith("self.") and re.search(rf"\bself\.{name}\.publish\(", written):
        return "misspelt", {"suggestion": own}
    hidden = re.search(rf"\b(math|random|rclpy|time)\.{name}\b", written)
    return None if hidden is None else ("hidden_module", {"name": hidden[1]})


def _own_attribute(owner: str, name: str, script: ScriptText) -> Closer:
    """Look for the attribute in the student's own class."""
    begins = script.class_line(owner)
    if begins is None:
        return None
    if name in _NODE_ATTRIBUTES and script.class_without_base(owner):
        return "no_base_class", {"line": begins}
    made = script.definition(name)
    if made is not None and (around := script.owner_of(made.line)) != begins:
        return _defined_elsewhere(owner, name, made, "" if around is None else script.lines[around - 1])
    given = script.lines_with(rf"\bself\.{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    if not given and (
        outside := script.lines_with(rf"^([\w ,]*, ?)?{re.escape(name)} ?(,[\w ,]*|:[^=]*)?=(?!=)")
    ):
        return "not_of_self", {"name": name, "given": outside[0], "call": ""}
    if len(given) == 1 and given[0] > begins:
        return "not_yet_assigned", {"name": name, "given": given[0]}
    near = [known for known in script.own_values if known != name and known.lower() == name.lower()]
    if near:
        return "misspelt", {"suggestion": near[0]}
    local = [] if given else script.lines_with(rf"^[ \t]+{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    return _local(name, local[0], script) if local and local[0] > begins else None


def _defined_elsewhere(owner: str, name: str, made: Definition, around: str) -> Closer:
    """Look at a ``def`` that is none of the class `owner`, and at the head of the block in which it stands."""
    if re.match(r"[ \t]*class\b", around):
        return None
    if re.match(r"[ \t]*def\b", around):
        return "method_inside", {"name": name, "owner": owner, "begins": made.line}
    if not around and not made.takes_self:
        return "not_of_self", {"name": name, "given": made.line, "call": "(...)"}
    return "method_outside", {"name": name, "owner": owner, "begins": made.line}


def _local(name: str, given: int, script: ScriptText) -> Closer:
    """Look at a variable of a function that is used as if it were the object's."""
    used = {script.function_around(n) for n in script.lines_with(rf"\bself\.{re.escape(name)}\b")}
    if used == {script.function_around(given)}:
        return "not_of_self", {"name": name, "given": given, "call": ""}
    node = script.object_at(given)
    made = node == "self" or any(n < given for n in script.lines_with(rf"\b{node} ?=(?!=)"))
    return ("local_only", {"name": name, "given": given, "object": node}) if made else None


def _module(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an import that failed."""
    found = re.match(r"No module named '([\w.]+)'", error.message)
    if found is None:
        return _imported_name(error)
    name = found[1]
    root = name.partition(".")[0]
    if root in ("_tkinter", "tkinter", "turtle"):
        return ("turtle_graphics" if script.lines_with(_TURTLE) else "no_display"), {}
    if name.rpartition(".")[2] in _NAMES_BY_MODULE.get(name.rpartition(".")[0], ()):
        return "import_statement", {"statement": _IMPORTS[name.rpartition(".")[2]]}
    if root in _LIBRARIES_NOT_HERE:
        return "library_not_here", {"name": root}
    near = [known for known in _MODULES if sorted(known) == sorted(name.lower())]
    near = near or difflib.get_close_matches(name, _MODULES, 1, 0.8)
    near = near or [one for one in _MODULES if one.partition(".")[0] == f"{root}_msgs"][:1]
    known = near and near[0].partition(".")[0] != name  # the package itself is not there
    return ("misspelt", {"suggestion": near[0]}) if known else None


def _imported_name(error: StudentError) -> Closer:
    found = re.match(r"cannot import name '(\w+)' from '([\w.]+)'", error.message)
    if found is None:
        return None
    name, module = found.groups()
    near = [known for known in _IMPORTS if known.lower() == name.lower()]
    near = near or difflib.get_close_matches(name, _NAMES_BY_MODULE.get(module, ()), 1, 0.75)
    return ("import_statement", {"statement": _IMPORTS[near[0]]}) if near else None


_TURTLE: Final = r"^[ \t]*(import[ \t]+turtle\b|from[ \t]+turtle[ \t]+import)"


def _window(error: StudentError, script: ScriptText) -> Closer:
    return ("turtle_graphics", {}) if script.lines_with(_TURTLE) else None


def _shut_down(error: StudentError, script: ScriptText) -> Closer:
    lines = script.lines_with(r"\bshutdown\(")
    if not lines and error.message == "__enter__":
        return "unknown_attribute", {}
    return "shutdown_early", {"where": _where(lines)}


def _shut_down_twice(error: StudentError, script: ScriptText) -> Closer:
    return "shutdown_twice", {"where": _where(script.lines_with(r"\bshutdown\("))}


def _destroyed(error: StudentError, script: ScriptText) -> Closer:
    return "destroyed_early", {"where": _where(script.lines_with(r"\bdestroy_\w+\("))}


def _base_class(error: StudentError, script: ScriptText) -> Closer:
    """Find the class whose ``__init__`` failed: the nearest one above."""
    above = [number for number in script.lines_with(r"^[ \t]*class[ \t]+\w+") if number <= (error.line or 0)]
    return ("no_base_class", {"line": above[-1]}) if above else None


def _urdf(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a model that PyBullet does not find: it may not know where its own ones are."""
    told = [line for line in script.lines_with(r"\bsetAdditionalSearchPath\(") if line < (error.line or 0)]
    return None if told or not script.has_code else ("urdf_path_missing", {})


def _service(error: StudentError, script: ScriptText) -> Closer:
    """Find the service's callback that does not return its response, or the request that lacks its parentheses."""
    for _, name in script.callbacks("service"):
        made = script.definition(name)
        given = (
            re.search(r"(\w+) ?\) ?(?:->.*)?:$", script.lines[made.line - 1]) if made is not None else None
        )
        if made is None or given is None:
            continue
        returned = re.findall(r"^[ \t]*return[ \t]+(\w+)$", "\n".join(script.block(made.line)), re.MULTILINE)
        if not any(one == given[1] or script.lines_with(rf"\b{one} ?=.*Response\(") for one in returned):
            return "no_response", {"name": name, "begins": made.line, "response": given[1]}
    bare = script.lines_with(r"= ?\w+\.Request$")
    return ("class_for_object", {"line": bare[0]}) if bare else None


def _args(error: StudentError, script: ScriptText) -> Closer:
    """Find the argument of a thread's function that lacks the comma of a tuple."""
    for line, found in script.matches(r"\btarget ?= ?.*\bargs ?= ?(?:\( ?([\w.]+) ?\)|([\w.]+) ?[,)])"):
        return "comma_of_args", {"line": line, "name": found[1] or found[2]}
    return "crashed", {}


def _made_late(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a node that was made without ``init``: it may have been named only, or ended already."""
    made = script.lines_with(rf"(?<!class )\b({script.node_class}|Node|create_node)\(")
    ended = [number for number in script.lines_with(r"\bshutdown\(") if made and number < made[-1]]
    begun = [number for number in script.lines_with(r"\brclpy\.init\(") if ended and number < ended[0]]
    if begun and script.function_around(ended[0]) == script.function_around(made[-1]):
        return "shutdown_early", {"where": _where(ended)}
    return _not_started(error, script)


def _where(lines: list[int]) -> Text | str:
    """Return the lines as they stand in a sentence; nothing when there are none."""
    if not lines:
        return ""
    numbers = enumerated([Text(zh=str(line), en=str(line)) for line in lines[:_MOST_LINES]])
    return say("detail.in_lines", lines=numbers)


_MOST_LINES: Final = 4
_REFINED: Final[Mapping[str, Callable[[StudentError, ScriptText], Closer]]] = {
    "assigned_later": _later,
    "foreign_character": _pasted,
    "keyword_of_own": _keyword,
    "module_called": _module_called,
    "reversed_sign": _reversed,
    "sign_of_maths": _sign,
    "words_in_code": _words,
    "wrong_type_in_field": _field_type,
    "comma_at_end": _comma,
    "function_not_called": _function,
    "int_in_float": _float,
    "no_input": _asked_again,
    "comma_of_args": _args,
    "no_request": _service,
    "urdf_not_found": _urdf,
    "not_initialized": _made_late,
    "syntax_error": _statement,
    "text_for_number": _text,
    "wrong_parameters": _parameters,
    "unknown_name": _own_name,
    "unknown_attribute": _attribute,
    "missing_module": _module,
    "no_display": _window,
    "shutdown_early": _shut_down,
    "shutdown_twice": _shut_down_twice,
    "destroyed_early": _destroyed,
    "no_base_class": _base_class,
}
"""For each code, what looks for a more precise one in the script and in the line that raised the exception."""


def script_line(error: StudentError) -> str:
    """Return the line that raised the exception, as the traceback shows it."""
    lines = error.traceback.splitlines()
    files = [i for i, line in enumerate(lines) if line.startswith("  File ")]
    return lines[files[-1] + 1].strip() if files and files[-1] + 1 < len(lines) else ""


def _first_line(message: str) -> str:
    """Return the first line of an exception's message, without the mark at its end or the path of a module."""
    line = message.strip().partition("\n")[0].rstrip(":.")
    return _MODULE_PATH.sub("", line)[:_LONGEST]
