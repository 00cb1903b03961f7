"""What an exception means to a beginner, whether it ended the script or kept it from being compiled.

Type and text of an exception tell which code it gets; the sentence ``mistake.<code>`` says what it means.
"""

import difflib
import keyword
import re
from collections.abc import Callable, Mapping
from typing import Final

from grader.contracts.outcome import StudentError
from grader.contracts.text import Text
from grader.messages import enumerated, say
from grader.messages.closer import Closer, looked_closer
from grader.messages.names import (
    IMPORTS,
    NEAR,
    NODE_PROPERTIES,
    SHELL,
    TURTLE,
    is_of_node,
    script_line,
    unknown_attribute,
    unknown_module,
    unknown_name,
)
from grader.messages.script import NO_SCRIPT, ScriptText

_AT: Final = r"\n(?:.*\n)*  File .*\n(?!(?:.*\n)*  File )"
"""Prefix of a pattern for the line that raised the exception: skips to the traceback's last ``File`` entry."""

_LINE: Final = r"(Syntax|Indentation|Tab)Error: .*\n.*\n +"
"""Prefix of a pattern for the line that Python rejects: skips to its first character."""


_SIGNS: Final = (
    (_LINE + r"\d+[.:|)]?[ \t]+(?!(and|else|for|if|in|is|not|or)\b)[A-Za-z_#@\"']", "line_numbers"),
    (_LINE + rf"(\./|{SHELL}[ \t]+(?!(and|else|for|if|in|is|not|or)\b)[^\s=(,])", "shell_line"),
    (r"SyntaxError: Missing parentheses in call to 'print'", "print_statement"),
    (r"SyntaxError: multiple exception types must be parenthesized", "except_comma"),
    (_LINE + r"<(\?xml|!DOCTYPE|html|launch|package|robot)\b", "markup_file"),
    (_LINE + r"(\}\s*)?(else[ \t]+if|elseif|elsif)\b", "else_if"),
    (_LINE + r"else[ \t]+[^:\n]+:", "else_condition"),
    (r"SyntaxError: invalid syntax\n.*\n +(?P<word>else|elif(?=[ \t]+\w))\b.*:", "else_alone"),
    (_LINE + r"(%\w|!\w|(In|Out) ?\[\d*\] ?:)", "pasted_mark"),
    (
        _LINE + r"(//|/\*|\}|(int|void)[ \t]+main[ \t]*\(|(for|while|if)[ \t]*\([^)\n]*;|"
        r"switch[ \t]*\(?\w[^=\n]*:|[^\"'#\n]*(\w(::|->)\w|=[ \t]*new[ \t]+\w|\)[ \t]*\{[ \t]*\n))",
        "c_syntax",
    ),
    (r"SyntaxError: invalid decimal literal" + r".*\n.*\n.*\d\.\d*f\b", "c_syntax"),
    (r"NameError: .*" + _AT + r".*[\d)\]]  +//+ *[A-Za-z\u4e00-\u9fff][\w ]*\n", "c_syntax"),
    (_LINE + r"[^\"'#\n]*\d[ \t]*(m/s|rad/s|rad|m|s|cm|米|秒|度|弧度)(?!\w)", "unit_in_code"),
    (_LINE + r"(.*\W)?(?P<name>[A-Za-z_][\w.]*)(\+\+|--)[ \t]*[;)]?[ \t]*(#.*)?\n", "increment"),
    (r"SyntaxError: .*Maybe you meant '==' .*\n.*\n +(if|elif|while)\b", "single_equals"),
    (_LINE + r"(if|elif|while|return|\w+[ \t]*=)\b[^\"'#\n]*(&&|\|\||![\w (])", "c_operator"),
    (
        _LINE + r"(def[ \t]+\w+[ \t]*\(([^()\n\"']*[ \t,])?)?"
        r"(int|float|double|bool|string|String|var|let|const|auto)[ \t]+[A-Za-z_][\w.]*[ \t]*([=;,)]|\n)",
        "typed_name",
    ),
    (_LINE + r"(class|def)[ \t]+\w+([ \t]+|-)\w+[ \t]*[(:]", "blank_in_name"),
    (_LINE + r"(?P<word>class|def)(?P<rest>\w+)[ \t]*\(.*:[ \t]*(#.*)?\n", "blank_after_word"),
    (r"SyntaxError: expression cannot contain assignment.*\n.*\n.*\w\.\w+[ \t]*=", "dotted_keyword"),
    (_LINE + r"(from|import)[ \t]+[\w.]*-", "hyphen_in_module"),
    (
        r"SyntaxError: invalid syntax\. Perhaps you forgot a comma\?.*\n.*\n[^\"'#\n]*\)[ \t]*[A-Z]\w*[ \t]*\(",
        "missing_comma",
    ),
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
    (_LINE + r"def[ \t]+\w+ *\(([\w.=, ]*,)? *[A-Za-z_]\w* +[A-Za-z_]\w* *[=,)]", "missing_comma"),
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
        r"SyntaxError: invalid syntax.*\n.*\n[^\"'#\n]*(\?\?|<[^<>\n]*[\u4e00-\u9fff][^<>\n]*>|"
        r"=[ \t]*(\n|#))",
        "unfinished_line",
    ),
    (r"SyntaxError: (unknown encoding|'\S+' (codec can't decode|is not a text encoding))", "wrong_coding"),
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
    (r"TypeError: module\(\) takes at most 2 arguments", "no_base_class"),
    (
        r"TypeError: (Node|Publisher|Clock|Rate|Timer)\.\w+\(\) takes 1 positional argument",
        "takes_nothing",
    ),
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
    (r"Aborted: field '(?P<field>(?!__)\w+)' of (?P<owner>[\w/]+): ", "wrong_type_at_publish"),
    (
        r"AssertionError: The '(?P<field>\w+)' field must be of type '(?P<type>bool|int|str)'",
        "wrong_type_in_field",
    ),
    (r"AssertionError: The '(?P<field>\w+)' field must be a set or sequence", "list_in_field"),
    (
        r"AssertionError: The 'result' field must be a sub message of type '(?P<owner>\w+)_Result'",
        "no_result",
    ),
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
    (r"AttributeError: .*has no attribute 'add_entity'" + _AT + r".*create_timer\(", "timer_arguments"),
    (
        r"(TypeError: 'Publisher' object is not callable|AttributeError: 'Publisher' object has no attribute "
        r"'(?!(?:.*\n)*.*Did you mean: 'publish'))",
        "publish_left_out",
    ),
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
    (r"AttributeError: module '.*' has no attribute 'main'\n(?!(?:.*\n)*  File )", "no_main"),
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
    (
        r"TypeError: (list|tuple|string) indices must be integers( or slices)?, not (float|.float)",
        "whole_number",
    ),
    (
        r"TypeError: (\w+\.)?sleep\(\) takes .*" + _AT + r".*\bsleep\([ \t]*\d+[ \t]*,[ \t]*\d+[ \t]*\)",
        "comma_in_float",
    ),
    (r"TypeError: (?P<name>\w+)\(\) takes no arguments", "no_init"),
    (r"RecursionError: ", "recursion"),
    (r"ValueError: generator already executing", "two_spins"),
    (r"TypeError: rclpy_resolve_name\(\)", "wrong_order"),
    (r"TypeError: __init__\(\): [^|]*\.(Service|Client)\(arg0", "wrong_order"),
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
    (
        r"(TypeError: init\(\) takes 0 positional|NameError: name 'arg[sv]*' is not).*"
        + _AT
        + r".*\brclpy\.init\(",
        "init_arguments",
    ),
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
    (r"TypeError: '(?!type)[\w.]+' object is not callable", "not_callable"),
    (r"TypeError: 'NoneType' object does not support the context manager protocol", "with_init"),
    (
        r"(AttributeError: (?=')(?!.*'handle')|TypeError: (?!.*(keyword|positional) argument))"
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
    (
        r"(NameError: name|AttributeError: .* has no attribute|ImportError: cannot import name) "
        r"'(_{2,}|TODO|FIXME|X{3,}|x{3,})'",
        "unfinished_line",
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
        r"ModuleNotFoundError: No module named '(getch|keyboard|msvcrt|pynput|readchar)\b",
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
_WITHOUT_WORDS: Final = Text(zh="没有更多说明", en="without a word")
_STATEMENTS: Final = (
    "break", "class", "continue", "def", "elif", "else", "except", "finally", "for", "from", "global", "if",
    "import", "pass", "raise", "return", "try", "while", "with",
)  # fmt: skip
_PROSE: Final = re.compile(
    r"(?=(?:[^\u4e00-\u9fff]*[\u4e00-\u9fff]){4})[\w\u3000-\u303f（），！：；？ /.+-]+"
)
"""A line of words and their punctuation, without the quotes and signs of code, wide ones such as ＝ included."""
_SIGNS_OF_MATHS: Final = {"×": "*", "÷": "/", "≤": "<=", "≥": ">=", "≠": "!=", "°": "math.radians(90)"}
_OF_TYPE: Final = {"bool": "True", "int": "int(x)", "str": "str(x)"}
_CALLS_OF_MODULES: Final = {"time": "time.time()", "random": "random.random()", "math": "math.sqrt(x)"}
_MOST_LINES: Final = 4


_OF_PASTED = ("SyntaxError", "IndentationError", "NameError")


def meaning(error: StudentError, otherwise: str, script: ScriptText = NO_SCRIPT) -> tuple[str, Text]:
    """Return the code of the mistake behind an exception, and the sentence that explains it.

    Args:
        error: the exception.
        otherwise: the code if nothing more precise is known.
        script: the script that raised the exception.
    """
    if error.type in _OF_PASTED and (pasted := script.terminal_line) is not None:
        return "terminal_output", say("mistake.terminal_output", line=pasted)
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


def _statement(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a line that Python does not take: its first word may be a misspelt one of Python's."""
    word = re.match(r"[ \t]*([a-z]+)[ \t]*=(?!=)", script_line(error))
    if word is not None and keyword.iskeyword(word[1]):
        return "keyword_as_name", {"name": word[1]}
    if (above := _without_comma(error, script)) is not None:
        return "missing_comma", {"line": above}
    found = re.match(r"([A-Za-z]+)(?=[ \t]+[A-Za-z_(\"']|[ \t]*:)", script_line(error))
    if found is None or (found[1] in _STATEMENTS and found[1] != "from"):
        return None
    name = found[1]
    behind = re.match(r"from[ \t]+[\w.]+[ \t]+(?!import\b)(\w+)[ \t]+[\w*]", script_line(error))
    if behind is not None:
        return "misspelt_keyword", {"name": behind[1], "suggestion": "import"}
    if name == "from":
        return None
    if re.match(r"(function|func|fn|sub|void)[ \t]+\w+[ \t]*\(.*:", script_line(error)):
        return "misspelt_keyword", {"name": name, "suggestion": "def"}
    same = [known for known in _STATEMENTS if sorted(known) == sorted(name.lower())]
    alike = [known for known in _STATEMENTS if known[0] == name[0].lower()]
    near = same or difflib.get_close_matches(name.lower(), alike, 1, NEAR)
    if near:
        return "misspelt_keyword", {"name": name, "suggestion": near[0]}
    return (
        ("prose", {}) if re.fullmatch(r"[A-Z][a-z']+(,? [A-Za-z']+){2,}[.:!]", script_line(error)) else None
    )


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
    fences, line = script.lines_with(r"^[ \t]*```"), script_line(error)
    if fences:
        return "pasted_mark", {"line": fences[0]}
    return (
        ("prose", {})
        if _PROSE.fullmatch(line) or re.fullmatch(r"[\u4e00-\u9fff]{2,}[：。！]", line)
        else None
    )


def _float(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a value that was assigned to a field of type float and is none."""
    given = script_line(error).partition("=")[2].partition("#")[0].strip()
    field = re.match(r"The '(\w+)'", error.message)
    if field is not None and given[:1] in ("'", '"'):
        return "text_in_float", {"field": field[1]}
    if field is not None and re.fullmatch(r"\[[^\[\]]*\]", given):
        return "list_in_float", {"field": field[1]}
    if given == "...":
        return "unfinished_line", {}
    return ("comma_in_float", {}) if re.match(r"-?\d+[ \t]*,[ \t]*\d+$", given) else None


def _later(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a variable without a value: it may have the name of what it is made from."""
    found = re.search(r"'(\w+)'", error.message)
    name = "" if found is None else found[1]
    if name and script.lines_with(rf"^[ \t]*import[ \t]+{name}$"):
        return "hidden_module", {"name": name}
    return ("name_hides_class", {"name": name}) if name in IMPORTS and name[:1].isupper() else None


def _indented(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a block that Python misses: where what follows it is right, nothing was written in it."""
    found = re.match(r"expected an indented block after (.*) on line (\d{1,6})$", error.message)
    begins, line = int(found[2]) if found else 0, error.line or 0
    if found is None or not 0 < begins <= line <= len(script.lines):
        return None
    head, behind = (script.lines[at - 1] for at in (begins, line))
    if found[1] == "class definition" and re.match(r"[ \t]*def \w+ ?\( ?self\b", behind):
        return None  # its own method, which is not indented
    ends = begins == line or re.match(r"[ \t]*(def|class|elif|else|except|finally|@|if __name__)", behind)
    outside = len(behind) - len(behind.lstrip()) < len(head) - len(head.lstrip())
    return ("empty_block", {"line": begins}) if ends or outside else None


def _sent(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at what a publisher has not: a method that would send a message, or something else."""
    found, written = re.search(r"attribute '(\w+)'", error.message), script_line(error)
    message = script.twist_name_at(error.line or 0)
    if found is not None and found[1] in ("linear", "angular") and message is not None:
        return "misspelt", {"suggestion": f"{message}.{found[1]}"}
    if found is not None and re.search(rf"\.{found[1]}\b(?!\([ \t]*[a-zA-Z_])", written):
        return unknown_attribute(error, script) or ("unknown_attribute", {})
    return "publish_left_out", {"publisher": script.publisher or "self.pub"}


def _nothing(error: StudentError, script: ScriptText) -> Closer:
    """Say how to call what takes no arguments; the logger was perhaps to log them."""
    name = error.message.partition("()")[0].rpartition(".")[2]
    logs = name == "get_logger" and not re.search(r"\)[ \t]*\.\w", script_line(error))
    return "takes_nothing", {"name": name, "call": "get_logger().info('...')" if logs else f"{name}()"}


def _no_init(error: StudentError, script: ScriptText) -> Closer:
    """Find the class that was given arguments and has no ``__init__`` of its own to take them."""
    name = error.message.partition("()")[0]
    begins = script.class_line(name)
    return ("crashed", {}) if begins is None else ("no_init", {"name": name, "begins": begins})


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
    lines = script.quoted_numbers
    if not lines and "multiply sequence" in error.message and not script.lines_with(r"\binput\(|\bargv\b"):
        return "sequence_times_number", {}
    return ("parameter_text", {"line": lines[0]}) if lines else None


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
    if found is not None and is_of_node(found[1], found[2], script):
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
    taken = script.methods(NODE_PROPERTIES)
    looked_at = r"super\(\)|\bspin|\badd_node\(" if "not iterable" in error.message else r"super\(\)"
    return ("name_taken", {"name": taken[0]}) if taken and re.search(looked_at, script_line(error)) else None


def _parameters(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a call with the wrong number of arguments: the caller may be wrong, or the function."""
    found = re.match(r"(?:\w+\.)?(\w+)\(\) ", error.message)
    name = "" if found is None else found[1]
    made = script.definition(name)
    if made is not None and script.calls_its_callback(error.line or 0, name):
        return "callback_called", {}
    if is_of_node(error.message.rpartition("()")[0].rpartition(".")[0], name, script):
        return "name_taken", {"name": name}
    owner = re.match(r"(\w+)\.__init__\(\)", error.message)
    if owner is not None and f"{owner[1]}(" in script_line(error):
        inits = script.lines_with(r"^[ \t]+def __init__ ?\( ?self\b")
        begun = [line for line in inits if script.owner_of(line) == script.class_line(owner[1])]
        if len(begun) == 1:
            return "init_mismatch", {"name": owner[1], "begins": begun[0]}
    is_method = re.match(r"\w+\.", error.message) is not None
    if made is None or (is_method and not made.takes_self) or f"{name}(" not in script_line(error):
        return None if is_method else ("crashed", {})
    return "call_mismatch", {"name": name, "begins": made.line}


def _window(error: StudentError, script: ScriptText) -> Closer:
    return ("turtle_graphics", {}) if script.lines_with(TURTLE) else None


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
    for service in script.callbacks("service"):
        block = script.block(service.begins)
        given = re.search(r"\(\s*(?:self ?, ?)?\w+[^,()]*, ?(\w+)", block[0])
        if given is None:
            continue
        returned = re.findall(r"^[ \t]*return[ \t]+(\S.*)$", "\n".join(block), re.MULTILINE)
        responses = rf"{given[1]}$|.*Response\("
        made_here = {one[1] for _, one in script.matches(r"(?<![\w.])(\w+) ?=(?!=).*Response\(")}
        if not any(re.match(responses, one) or one in made_here for one in returned):
            return "no_response", {"name": service.name, "begins": service.begins, "response": given[1]}
    bare = script.lines_with(r"= ?\w+\.Request$")
    return ("class_for_object", {"line": bare[0]}) if bare else None


def _args(error: StudentError, script: ScriptText) -> Closer:
    """Find the argument of a thread's function that lacks the comma of a tuple."""
    for line, found in script.matches(r"\btarget ?= ?.*\bargs ?= ?(?:\( ?([\w.]+) ?\)|([\w.]+) ?[,)])"):
        return "comma_of_args", {"line": line, "name": found[1] or found[2]}
    return "crashed", {}


def _made_late(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at a node that was made without ``init``: it was named only, ended already, or never reached."""
    made = script.lines_with(rf"(?<!class )\b({script.node_class}|Node|create_node)\(")
    ended = [number for number in script.lines_with(r"\bshutdown\(") if made and number < made[-1]]
    begun = [number for number in script.lines_with(r"\brclpy\.init\(") if ended and number < ended[0]]
    if begun and script.function_around(ended[0]) == script.function_around(made[-1]):
        return "shutdown_early", {"where": _where(ended)}
    functions = {script.function_around(line) for line in script.lines_with(r"\brclpy\.init\(")}
    name = functions.pop() if len(functions) == 1 else ""
    if (main := script.definition(name)) is not None and not script.calls(name):
        return "never_called", {"name": name, "begins": main.line}
    return _not_started(error, script)


def _object_for_class(error: StudentError, script: ScriptText) -> Closer:
    """Find the publisher that was given an object for the class of its messages, which shows at ``publish``."""
    lines = script.lines_with(r"\bcreate_publisher\( ?\w+\( ?\)") if "isinstance" in error.message else []
    return ("wrong_order", {"line": lines[0]}) if lines else None


def _where(lines: list[int]) -> Text | str:
    """Return the lines as they stand in a sentence; nothing when there are none."""
    if not lines:
        return ""
    numbers = enumerated([Text(zh=str(line), en=str(line)) for line in lines[:_MOST_LINES]])
    return say("detail.in_lines", lines=numbers)


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
    "indentation": _indented,
    "no_init": _no_init,
    "publish_left_out": _sent,
    "takes_nothing": _nothing,
    "int_in_float": _float,
    "no_input": _asked_again,
    "comma_of_args": _args,
    "no_request": _service,
    "urdf_not_found": _urdf,
    "not_initialized": _made_late,
    "wrong_order": _object_for_class,
    "syntax_error": _statement,
    "text_for_number": _text,
    "wrong_parameters": _parameters,
    "unknown_name": unknown_name,
    "unknown_attribute": unknown_attribute,
    "missing_module": unknown_module,
    "no_display": _window,
    "shutdown_early": _shut_down,
    "shutdown_twice": _shut_down_twice,
    "destroyed_early": _destroyed,
    "no_base_class": _base_class,
}
"""For each code, what looks for a more precise one in the script and in the line that raised the exception."""


def _first_line(message: str) -> str:
    """Return the first line of an exception's message, without the mark at its end or the path of a module."""
    line = message.strip().partition("\n")[0].rstrip(":.")
    return _MODULE_PATH.sub("", line)[:_LONGEST]
