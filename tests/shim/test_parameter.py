"""Parameters: declaring, reading, setting, ranges, services."""

from textwrap import dedent

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


def test_parameter_files(run_script):
    script = """
        from rclpy._rcl.yaml import parse_document, parse_value
        print(parse_document("/**:\\n  ros__parameters:\\n    s: 0.5 # c\\n    l:\\n      - 1\\n      - 2\\n"
            "    n:\\n      f: no\\nwalker:\\n  ros__parameters: {}\\n".replace(" {}", "")))
        for text in ("1", "0x10", "1.0", "1e3", ".inf", "yes", "'yes'", "abc", "[1, 2.5]", "['a', b]", "[]"):
            print(repr(parse_value(text)), end=" ")
    """
    assert run_lines(run_script, script) == [
        "{'/**': {'ros__parameters': {'s': 0.5, 'l': [1, 2], 'n': {'f': False}}}, "
        "'walker': {'ros__parameters': ''}}",
        "1 16 1.0 1000.0 inf True 'yes' 'abc' [1.0, 2.5] ['a', 'b'] [] ",
    ]
