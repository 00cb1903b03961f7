"""Parameters: declaring, reading, setting, ranges, services."""

import math
from textwrap import dedent

import pytest

PREFIX = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, ParameterEvent, SetParametersResult
rclpy.init()
node = Node("n")
def attempt(call):
    try:
        print(call())
    except Exception as error:
        print(type(error).__name__, error)
def set_(name, value):
    result = node.set_parameters([Parameter(name, value=value)])[0]
    print(result.successful, result.reason)
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_declare_get_set(run_script):
    source = """
        print(node.declare_parameter("speed", 1.5).value, node.get_parameter("speed").value)
        print(node.get_parameter("speed").get_parameter_value().double_value)
        attempt(lambda: node.get_parameter("other"))
        attempt(lambda: node.declare_parameter("speed", 2.0))
        attempt(lambda: node.declare_parameter("", 2.0))
        set_("speed", 2.0)
        set_("speed", "fast")
        print(node.get_parameter("speed").value, node.has_parameter("speed"), node.has_parameter("x"))
        print(node.get_parameter_or("x", Parameter("x", value=3)).value)
        print(sorted(node.get_parameters_by_prefix("")))
        node.undeclare_parameter("speed")
        attempt(lambda: node.undeclare_parameter("speed"))
    """
    assert run_lines(run_script, source) == [
        "1.5 1.5",
        "1.5",
        "ParameterNotDeclaredException ('Invalid access to undeclared parameter(s)', 'other')",
        "ParameterAlreadyDeclaredException ('Parameter(s) already declared', ['speed'])",
        "InvalidParameterException ('Invalid parameter name', '')",
        "True ",
        "False Wrong parameter type, expected 'Type.DOUBLE' got 'Type.STRING'",
        "2.0 True False",
        "3",
        "['speed', 'use_sim_time']",
        "ParameterNotDeclaredException ('Invalid access to undeclared parameter(s)', 'speed')",
    ]


def test_types_and_uninitialised_parameters(run_script):
    source = """
        node.declare_parameter("count", Parameter.Type.INTEGER)
        attempt(lambda: node.get_parameter("count"))
        set_("count", 3)
        attempt(lambda: node.get_parameter("count").value)
        for value in (True, 1, 1.0, "a", [True], [1], [1.0], ["a"], [b"x"], None):
            print(Parameter("p", value=value).type_.name, end=" ")
        print()
        attempt(lambda: Parameter("p", Parameter.Type.BOOL, 1))
        attempt(lambda: Parameter("p", value={}))
    """
    assert run_lines(run_script, source) == [
        "ParameterUninitializedException The parameter 'count' is not initialized",
        "True ",
        "3",
        "BOOL INTEGER DOUBLE STRING BOOL_ARRAY INTEGER_ARRAY DOUBLE_ARRAY STRING_ARRAY BYTE_ARRAY NOT_SET ",
        "ValueError Type 'Type.BOOL' and value '1' do not agree",
        "TypeError The given value is not one of the allowed types '{}'.",
    ]


def test_ranges_read_only_and_callbacks(run_script):
    source = """
        descriptor = ParameterDescriptor(
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0, step=0.25)])
        node.declare_parameter("gain", 0.5, descriptor)
        node.declare_parameter("fixed", 1, ParameterDescriptor(read_only=True))
        set_("gain", 2.0)
        set_("gain", 0.3)
        set_("gain", 0.75)
        set_("fixed", 2)
        attempt(lambda: node.undeclare_parameter("fixed"))
        attempt(lambda: node.declare_parameter("more", 5.0, descriptor))
        def judge(parameters):
            return SetParametersResult(successful=all(p.value != 1.0 for p in parameters), reason="not 1")
        node.add_on_set_parameters_callback(judge)
        set_("gain", 1.0)
        set_("gain", 0.0)
    """
    assert run_lines(run_script, source) == [
        "False Parameter gain out of range Min: 0.0, Max: 1.0, value: 2.0",
        "False The parameter value for gain is not close enough to a valid step. "
        "Min: 0.0, max: 1.0, value: 0.3, step: 0.25",
        "True ",
        "False Trying to set a read-only parameter: fixed.",
        "ParameterImmutableException ('Attempted to modify read-only parameter', 'fixed')",
        "InvalidParameterValueException ('Invalid parameter value (5.0) for parameter. Reason: "
        "Parameter more out of range Min: 0.0, Max: 1.0, value: 5.0', 'more')",
        "False not 1",
        "True ",
    ]


def test_services_and_events(run_script):
    source = """
        from rcl_interfaces.srv import *
        node.declare_parameter("a.b", 1)
        node.create_subscription(ParameterEvent, "/parameter_events",
            lambda e: print(e.node, [p.name for p in e.changed_parameters]), 10)
        def call(kind, name, **fields):
            client = node.create_client(kind, f"/n/{name}")
            future = client.call_async(kind.Request(**fields))
            rclpy.spin_until_future_complete(node, future)
            return future.result()
        print(call(ListParameters, "list_parameters").result.names)
        print([v.integer_value for v in call(GetParameters, "get_parameters", names=["a.b"]).values])
        print(call(GetParameters, "get_parameters", names=["nothing"]).values)
        change = [Parameter("a.b", value=7).to_parameter_msg(), Parameter("zzz", value=7).to_parameter_msg()]
        print([r.successful for r in call(SetParameters, "set_parameters", parameters=change).results])
        rclpy.spin_once(node, timeout_sec=0.1)
        print(node.get_parameter("a.b").value)
    """
    out = run_lines(run_script, source)
    assert out[:3] == ["['use_sim_time', 'a.b']", "[1]", "[]"]
    assert sorted(out[3:]) == sorted(["/n ['a.b']", "[True, False]", "7"])


MIXED = "Sequence should be of same type. Value type '{}' do not belong at line_num {}, at ./src/parse.c:{}"
VALUES = """
import rclpy
from rclpy.node import Node
def show(*args):
    context = rclpy.Context()
    try:
        rclpy.init(args=["--ros-args", *args], context=context)
        print(Node("n", namespace="ns", context=context).handle.get_parameters(lambda n, value: (n, value)))
    except RuntimeError as error:
        print(str(error).partition("Error: ")[2])
"""


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *[("hello", "hello"), ("'1'", "1"), ("a b", "a b"), ("a:b", "a:b"), ("~", "~"), ("1_000", "1_000")],
        *[("1", 1), ("+5", 5), ("010", 8), ("08", 8.0), ("0x10", 16), ("-0x10", -16), ("0", 0)],
        *[("12345678901234567890", 1.2345678901234567e19), ("1e3", 1000.0), (".5", 0.5), ("5.", 5.0)],
        *[("-.INF", -math.inf), (".nan", math.nan)],
        *[
            ("1e400", "1e400"),
            ("1e-400", "1e-400"),
            ("inf", math.inf),
            ("-infinity", -math.inf),
            ("0x1p3", 8.0),
        ],
        *[("yes", True), ("OFF", False), ("tRue", "tRue"), ("'yes'", "yes")],
        *[
            ("[1, 2]", [1, 2]),
            ("[a, 'b']", ["a", "b"]),
            ("[true]", [True]),
            ("- 1", [1]),
            ("[[1, 2], [3, 4]]", [3, 4]),
        ],
        *[("[]", None), ("#c", None)],
    ],
)
def test_values_are_read_as_rcl_yaml_param_parser_reads_them(run_script, text, value):
    """parse.c:83 (get_value): a bool by its name, else strtoll with base 0, strtod unless ERANGE, or the text."""
    run = run_script(f"{VALUES}show('-p', {'x:=' + text!r})\n")
    assert run.stdout == f"{ {'x': ('x', value)} }\n", run.stderr


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "error not set"),
        ("''", ""),
        ("[1, 2.0]", MIXED.format("double", 1, 378)),
        ("[1.0, 2]", MIXED.format("integer", 1, 337)),
        ("[true, a]", MIXED.format("string", 1, 422)),
        ("{x: 1}", "Unknown YAML event, at ./src/parse.c:952"),
        ("a: 1", "Unknown YAML event, at ./src/parse.c:952"),
        ("[1, 2", "Error parsing an event, at ./src/parse.c:922"),
        ("&a", "No value at line 1, at ./src/parse.c:245"),
    ],
)
def test_values_are_refused_where_rcls_parser_refuses_them(run_script, text, fault):
    run = run_script(f"{VALUES}show('-p', {'x:=' + text!r})\n")
    expected = f"{fault}, at ./src/rcl/arguments.c:343" if fault else "{'x': ('x', '')}"
    assert run.stdout == f"{expected}\n", run.stderr


def test_a_scalar_of_an_earlier_rule_stays_beside_one_of_another_type(run_script):
    """rcl keeps one of each type; rclpy takes the first of bool, integer, double, string (node.cpp:205)."""
    source = "show('-p', 'x:=1', '-p', 'x:=one', '-p', 'x:=2', '-p', 'x:=[3]')\n"
    assert run_script(VALUES + source).stdout == "{'x': ('x', 2)}\n"


FILE = """
/**:
  ros__parameters:
    speed: 2.5   # m/s
    nested: {k: 1, l: [1.0, 2.0]}
    deep:
      f: no
      items:
      - a
      - b
ns:
  "n":
    ros__parameters:
      mine: 'it''s'
/ns/other:
  ros__parameters:
    not_mine: 4
"""


def test_parameter_files(run_script):
    source = f"open('/tmp/p.yaml', 'w').write({FILE!r})\nshow('--params-file', '/tmp/p.yaml')\n"
    expected = {
        "speed": 2.5,
        "nested.k": 1,
        "nested.l": [1.0, 2.0],
        "deep.f": False,
        "deep.items": ["a", "b"],
    }
    expected["mine"] = "it's"
    assert (
        run_script(VALUES + source).stdout
        == f"{ {name: (name, value) for name, value in expected.items()} }\n"
    )


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("a:\n  speed: 1\n", "Cannot have a value before ros__parameters at line 2, at ./src/parse.c:793"),
        ("a:\n  ros__parameters:\n", "Cannot have a value before ros__parameters at line 2, at ./src/parse.c:805"),
        ("ros__parameters:\n  a: 1\n", "There are no node names before ros__parameters at line 1, "
            "at ./src/parse.c:629"),
        ("a:\n  ros__parameters:\n    b:\n", "No value at line 3, at ./src/parse.c:245"),
        ("a:\n  ros__parameters:\n    b: [1, x]\n", MIXED.format("string", 3, 422)),
        ("a:\n  - b\n", "Sequences can only be values and not keys in params. Error at line 2\n, "
            "at ./src/parse.c:828"),
        ("- a\n", "Sequences cannot be key at line 1, at ./src/parse.c:822"),
        ("a:\n  ros__parameters:\n    b: *c\n", "Will not support aliasing at line 3\n, at ./src/parse.c:880"),
        ("a:\n\tros__parameters: 1\n", "Error parsing a event near line 1, at ./src/parse.c:769"),
        ("my-node:\n  ros__parameters:\n    b: 1\n", "node name must not contain characters other than "
            "alphanumerics or '_', at ./src/parse.c:477"),
        (None, "Error opening YAML file, at ./src/parser.c:270"),
    ],
)  # fmt: skip
def test_parameter_files_are_refused_where_rcls_parser_refuses_them(run_script, text, fault):
    write = "" if text is None else f"open('/tmp/p.yaml', 'w').write({text!r})\n"
    run = run_script(f"{VALUES}{write}show('--params-file', '/tmp/p.yaml')\n")
    assert run.stdout == f"{fault}, at ./src/rcl/arguments.c:406\n", run.stderr


def test_integers_of_more_than_64_bits_are_refused_and_not_kept(run_script):
    source = """
        attempt(lambda: node.declare_parameter("big", 2**63))
        attempt(lambda: node.declare_parameter("many", [1, -2**63 - 1]))
        node.declare_parameter("n", 2**63 - 1)
        attempt(lambda: node.set_parameters([Parameter("n", value=-2**70)]))
        print(node.get_parameter("n").value, node.has_parameter("big"))
    """
    whole = "[-9223372036854775808, 9223372036854775807]"
    lines = run_lines(run_script, source)
    assert lines[0] == f"AssertionError The 'integer_value' field must be an integer in {whole}"
    assert lines[1].startswith("AssertionError The 'integer_array_value' field must be a set or sequence")
    assert lines[2:] == [lines[0], "9223372036854775807 False"]
