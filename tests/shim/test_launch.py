"""launch and launch_ros: the names that each release has, and what actions and substitutions come to.

The names are those of ``__all__`` upstream: launch 1.0.7 and launch_ros 0.19.8 (Humble), 3.4.3 and 0.26.6 (Jazzy).
"""

from collections.abc import Callable

import pytest

from tests.shim.conftest import Run
from tests.shim.test_files import SITE_PACKAGES

RunScript = Callable[..., Run]

NAMES = {
    "launch": """Action Condition Event EventHandler InvalidLaunchFileError LaunchContext LaunchDescription
        LaunchDescriptionEntity LaunchDescriptionSource LaunchIntrospector LaunchService SomeSubstitutionsType
        SomeSubstitutionsType_types_tuple Substitution actions conditions descriptions events logging
        substitutions""",
    "launch.actions": """AppendEnvironmentVariable DeclareLaunchArgument EmitEvent ExecuteLocal ExecuteProcess
        GroupAction IncludeLaunchDescription LogInfo OpaqueCoroutine OpaqueFunction PopEnvironment
        PopLaunchConfigurations PushEnvironment PushLaunchConfigurations ResetEnvironment ResetLaunchConfigurations
        RegisterEventHandler SetEnvironmentVariable SetLaunchConfiguration Shutdown TimerAction
        UnregisterEventHandler UnsetEnvironmentVariable UnsetLaunchConfiguration""",
    "launch.conditions": """IfCondition InvalidConditionExpressionError LaunchConfigurationEquals
        LaunchConfigurationNotEquals UnlessCondition evaluate_condition_expression""",
    "launch.descriptions": "Executable",
    "launch.event_handlers": """event_named OnExecutionComplete OnIncludeLaunchDescription OnProcessExit
        OnProcessIO OnProcessStart OnShutdown""",
    "launch.events": "matches_action process ExecutionComplete IncludeLaunchDescription Shutdown TimerEvent",
    "launch.events.process": """matches_executable matches_name matches_pid ProcessExited ProcessIO ProcessStarted
        ProcessStderr ProcessStdin ProcessStdout ProcessTargetedEvent RunningProcessEvent ShutdownProcess
        SignalProcess""",
    "launch.launch_description_sources": """get_launch_description_from_any_launch_file
        get_launch_description_from_python_launch_file get_launch_description_from_frontend_launch_file
        InvalidFrontendLaunchFileError InvalidLaunchFileError InvalidPythonLaunchFileError
        load_python_launch_file_as_module AnyLaunchDescriptionSource FrontendLaunchDescriptionSource
        PythonLaunchDescriptionSource""",
    "launch.substitutions": """AndSubstitution AnonName Command EnvironmentVariable FindExecutable
        LaunchConfiguration LocalSubstitution NotSubstitution OrSubstitution PathJoinSubstitution PythonExpression
        SubstitutionFailure TextSubstitution ThisLaunchFile ThisLaunchFileDir""",
    "launch.utilities": "perform_substitutions normalize_to_list_of_substitutions ensure_argument_type",
    "launch_ros": "actions descriptions event_handlers events substitutions",
    "launch_ros.actions": """ComposableNodeContainer LifecycleNode LoadComposableNodes Node PushRosNamespace
        RosTimer SetParameter SetParametersFromFile SetRemap SetUseSimTime""",
    "launch_ros.descriptions": "ComposableNode Parameter ParameterFile ParameterValue",
    "launch_ros.event_handlers": "OnStateTransition",
    "launch_ros.events": "lifecycle matches_node_name",
    "launch_ros.events.lifecycle": "ChangeState matches_node_name StateTransition",
    "launch_ros.substitutions": "ExecutableInPackage FindPackage FindPackagePrefix FindPackageShare Parameter",
}
ONLY_ON_HUMBLE = {"launch": "SomeActionsType SomeActionsType_types_tuple"}
ONLY_ON_JAZZY = {
    "launch": "SomeEntitiesType SomeEntitiesType_types_tuple",
    "launch.substitutions": """AllSubstitution AnySubstitution EqualsSubstitution FileContent IfElseSubstitution
        LaunchLogDir NotEqualsSubstitution""",
    "launch_ros.actions": "LifecycleTransition PushROSNamespace ROSTimer SetROSLogDir",
}
MISSING = """
from importlib import import_module
for module, names in {names}.items():
    for name in names.split():
        if not hasattr(import_module(module), name):
            print(module, name)
"""


def names_missing(run_script: RunScript, distro: str, names: dict[str, str]) -> set[str]:
    run = run_script(MISSING.replace("{names}", repr(names)), distro=distro)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.splitlines())


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_each_release_has_its_public_names(run_script: RunScript, distro: str) -> None:
    own, other = ONLY_ON_HUMBLE, ONLY_ON_JAZZY
    if distro == "jazzy":
        own, other = other, own
    assert names_missing(run_script, distro, NAMES) == set()
    assert names_missing(run_script, distro, own) == set()
    assert names_missing(run_script, distro, other) == {
        f"{module} {name}" for module, names in other.items() for name in names.split()
    }


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("launch.action", "Action"),
        ("launch.actions.execute_process", "ExecuteProcess"),
        ("launch.actions.shutdown_action", "Shutdown"),
        ("launch.conditions.if_condition", "IfCondition"),
        ("launch.event_handler", "BaseEventHandler"),
        ("launch.event_handlers.on_process_io", "OnProcessIO"),
        ("launch.events.matchers", "matches_action"),
        ("launch.events.process.process_exited", "ProcessExited"),
        ("launch.events.shutdown", "Shutdown"),
        ("launch.launch_context", "LaunchContext"),
        ("launch.launch_description", "LaunchDescription"),
        (
            "launch.launch_description_sources.python_launch_description_source",
            "PythonLaunchDescriptionSource",
        ),
        ("launch.launch_service", "LaunchService"),
        ("launch.some_substitutions_type", "SomeSubstitutionsType_types_tuple"),
        ("launch.substitutions.boolean_substitution", "NotSubstitution"),
        ("launch.substitutions.launch_configuration", "LaunchConfiguration"),
        ("launch.utilities.perform_substitutions_impl", "perform_substitutions"),
        ("launch_ros.actions.node", "Node"),
        ("launch_ros.actions.push_ros_namespace", "PushRosNamespace"),
        ("launch_ros.descriptions.composable_node", "ComposableNode"),
        ("launch_ros.parameter_descriptions", "ParameterFile"),
        ("launch_ros.substitutions.find_package", "FindPackageShare"),
    ],
)
def test_each_class_can_be_imported_from_its_own_module(
    run_script: RunScript, module: str, name: str
) -> None:
    package = module.rpartition(".")[0] or module
    same = f"import {package}\nprint(getattr({package}, {name!r}, {name}) is {name})\n"
    run = run_script(f"from {module} import {name}\n{same}")
    assert run.stdout == "True\n", run.stderr


def test_a_module_of_jazzy_is_none_of_humble(run_script: RunScript) -> None:
    script = "from launch.substitutions.equals_substitution import EqualsSubstitution\nprint('there')\n"
    assert run_script(script, distro="jazzy").stdout == "there\n"
    assert "ModuleNotFoundError: No module named 'launch.substitutions.equals" in run_script(script).stderr


BEFORE = """
import os
import launch
from launch import *
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *
from launch_ros.substitutions import *
context = launch.LaunchContext()
def said(*entities):
    context.visit(entities)
    context.answer_events()
def text(*parts):
    return LogInfo(msg=list(parts))
X = LaunchConfiguration('x', default='none')
"""


def visited(run_script: RunScript, script: str, distro: str = "humble") -> Run:
    return run_script(BEFORE + script, distro=distro, preload=[SITE_PACKAGES])


def lines(run: Run) -> list[str]:
    assert run.returncode == 0, run.stderr
    return [line.removeprefix("[INFO] [launch.user]: ") for line in run.stdout.splitlines()]


def test_a_group_is_a_scope_of_arguments_and_environment(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
V = EnvironmentVariable('V', default_value='unset')
both = text(X, ' ', V)
said(
    SetLaunchConfiguration('x', '1'), SetEnvironmentVariable('V', 'a'), both,
    GroupAction([both, SetLaunchConfiguration('x', '3'), SetEnvironmentVariable('V', 'b'), both],
                launch_configurations={'x': '2'}),
    both,
    GroupAction([both], forwarding=False),
    GroupAction([both], forwarding=False, launch_configurations={'x': [X, '!']}),
    GroupAction([both], scoped=False, launch_configurations={'x': '5'}), both,
)
""",
    )
    assert lines(run) == ["1 a", "2 a", "3 b", "1 a", "none unset", "1! unset", "5 a", "5 a"]


def test_arguments_and_environment_are_set_pushed_and_taken_away(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
V = EnvironmentVariable('V', default_value='unset')
said(
    AppendEnvironmentVariable('V', 'a'), AppendEnvironmentVariable('V', 'b'),
    AppendEnvironmentVariable('V', 'c', prepend=True, separator='-'), text(V),
    PushEnvironment(), UnsetEnvironmentVariable('V'), UnsetEnvironmentVariable('V'), text(V), PopEnvironment(),
    text(V), ResetEnvironment(), text(V),
    SetLaunchConfiguration('x', '1'), PushLaunchConfigurations(), UnsetLaunchConfiguration('x'), text(X),
    PopLaunchConfigurations(), text(X), ResetLaunchConfigurations({'y': X}), text(X, LaunchConfiguration('y')),
)
try:
    said(PopEnvironment())
except RuntimeError as error:
    print(error)
""",
    )
    assert lines(run) == [
        "c-a:b", "unset", "c-a:b", "unset", "none", "1", "none1", "environment stack unexpectedly empty",
    ]  # fmt: skip


def test_events_are_answered_by_the_handlers_that_wait_for_them(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
class Mine(launch.Event):
    name = 'mine'
once = launch.EventHandler(matcher=event_named('mine'), entities=[text('once')], handle_once=True)
always = launch.EventHandler(matcher=lambda event: isinstance(event, Mine), entities=text('always'))
first = LogInfo(msg='first')
said(
    RegisterEventHandler(OnShutdown(on_shutdown=[text('down: ', LocalSubstitution('event.reason'))])),
    RegisterEventHandler(OnExecutionComplete(
        target_action=first, on_completion=lambda event, context: [text('after first')])),
    RegisterEventHandler(always), RegisterEventHandler(once),
    EmitEvent(event=Mine()), EmitEvent(event=Mine()), first,
    launch.actions.Shutdown(reason='enough'),
)
said(UnregisterEventHandler(always), EmitEvent(event=Mine()))
try:
    said(UnregisterEventHandler(always))
except ValueError as error:
    print(error)
""",
    )
    assert lines(run) == [
        "first", "once", "always", "always", "after first", "down: enough", "deque.remove(x): x not in deque",
    ]  # fmt: skip


def test_a_process_has_name_command_folder_environment_and_number(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
def about(event, context):
    print(event.name, event.process_name, event.cmd, event.cwd, event.env['A'], event.pid == os.getpid() + 1)
    print(event.action is command, matches_action(command)(event.action), process.matches_name('say-1')(command))
command = ExecuteProcess(cmd=['echo', X], name='say', cwd='/tmp', additional_env={'A': ['b', X]})
print(command.process_details, process.matches_pid(1)(command))
said(
    RegisterEventHandler(OnProcessStart(target_action=command, on_start=about)),
    RegisterEventHandler(OnProcessExit(on_exit=lambda event, context: print(event.name, event.returncode))),
    RegisterEventHandler(OnExecutionComplete(target_action=command, on_completion=[text('completed')])),
    command,
)
print(command.cmd, command.name, command.return_code)
""",
    )
    assert lines(run) == [
        "None False",
        "launch.events.process.ProcessStarted say-1 ['echo', 'none'] /tmp bnone True",
        "True True True",
        "launch.events.process.ProcessExited 0",
        "completed",
        "['echo', 'none'] say-1 0",
    ]


@pytest.mark.parametrize(
    ("substitution", "said"),
    [
        ("NotSubstitution('true')", "false"),
        ("AndSubstitution('true', 'no')", "false"),
        ("OrSubstitution('true', 'no')", "true"),
        ("NotSubstitution('1')", "SubstitutionFailure: Cannot convert value '1' to '<class 'bool'>'"),
        ("PythonExpression(['sqrt(', '4.0', ')'])", "2.0"),
        ("AnonName('a')", "a_"),
        ("Command('ls')", "CommandNotRunError: no command can be run here: ls"),
        (
            "TextSubstitution(text=2.5)",
            "TypeError: TextSubstitution expected Text object got '<class 'float'>'",
        ),
        ("PythonExpression('1', ['os'])", "TypeError: PythonExpression.__init__() takes 2 positional"),
        (
            "LocalSubstitution('nothing')",
            "AttributeError: context.locals does not contain attribute 'nothing'",
        ),
    ],
)
def test_what_a_substitution_comes_to(run_script: RunScript, substitution: str, said: str) -> None:
    performed(run_script, "humble", substitution, said)


@pytest.mark.parametrize(
    ("substitution", "said"),
    [
        ("EqualsSubstitution('1.0', 1)", "true"),
        ("EqualsSubstitution('True', '1')", "true"),
        ("EqualsSubstitution(X, None)", "false"),
        ("NotEqualsSubstitution(X, 'none')", "false"),
        ("IfElseSubstitution('on', 'a', 'b')", "a"),
        ("IfElseSubstitution('off', 'a')", ""),
        ("IfElseSubstitution('on')", "RuntimeError: One of if_value and else_value must be specified"),
        ("AllSubstitution('true', 'yes')", "true"),
        ("AnySubstitution('false', 'no')", "false"),
        ("FileContent('/nowhere')", "SubstitutionFailure: File not found: /nowhere"),
        ("PythonExpression('math.pi > 3 and pi > 3')", "True"),
        ("PythonExpression('os.sep', ['os'])", "/"),
        ("PythonExpression('pi', ['os'])", "NameError: name 'pi' is not defined"),
        ("LaunchLogDir()", "/home/student/.ros/log/"),
    ],
)
def test_what_a_substitution_of_jazzy_comes_to(run_script: RunScript, substitution: str, said: str) -> None:
    performed(run_script, "jazzy", substitution, said)


def performed(run_script: RunScript, distro: str, substitution: str, said: str) -> None:
    run = visited(
        run_script,
        f"try:\n    print({substitution}.perform(context))\n"
        "except Exception as error:\n    print(f'{type(error).__name__}: {error}')\n",
        distro,
    )
    assert run.stdout.startswith(said), run.stdout + run.stderr
    assert said or run.stdout == "\n"


def test_a_coroutine_is_carried_out(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
async def wait(context, word):
    import asyncio
    await asyncio.sleep(1.0)
    print(word, type(context).__name__)
said(OpaqueCoroutine(coroutine=wait, args=['waited']), text('then'))
""",
    )
    assert lines(run) == ["waited LaunchContext", "then"]


def test_a_service_of_launch_says_that_it_starts_nothing(run_script: RunScript) -> None:
    run = visited(
        run_script,
        "service = launch.LaunchService(argv=[])\n"
        "service.include_launch_description(LaunchDescription([]))\nservice.run()\n",
    )
    assert (
        "NotImplementedError: LaunchService.run() starts processes, and none can be started here"
        in run.stderr
    )


def test_loggers_of_launch_print_as_launch_does(run_script: RunScript) -> None:
    run = visited(run_script, "import launch.logging\nlaunch.logging.get_logger('mine').warning('%d', 3)\n")
    assert run.stdout == "[WARNING] [mine]: 3\n"


NODE = """
def args(*before, **node):
    context.started.clear()
    said(*before, Node(package='p', executable='e', **node))
    return ' '.join(context.started[-1][2].arguments)
"""


def test_what_holds_for_all_nodes_of_a_group(run_script: RunScript) -> None:
    run = visited(
        run_script,
        NODE
        + """
open('/tmp/a.yaml', 'w').write('/**: {ros__parameters: {speed: 1.0}}')
print(args(name='n', remappings=[('a', 'b')]))
def group(*entities):
    context.started.clear()
    said(GroupAction([*entities, Node(package='p', executable='e', remappings=[('a', 'b')])]))
    print(' '.join(context.started[-1][2].arguments))
group(SetRemap('c', X), SetRemap('d', 'e'))
group(SetParametersFromFile('/tmp/a.yaml'))
group(PushRosNamespace('a'), PushRosNamespace('b'))
group(PushRosNamespace('a'), PushRosNamespace('/b'))
group(SetParameter('speed', 2.0), SetUseSimTime(True), text(Parameter('speed')))
print(args(namespace='x/'), '|', args(namespace='/', name='m'))
""",
    )
    assert lines(run) == [
        "--ros-args -r __node:=n -r a:=b",
        "--ros-args -r c:=none -r d:=e -r a:=b",
        "--ros-args --params-file /tmp/a.yaml -r a:=b",
        "--ros-args -r __ns:=/a/b -r a:=b",
        "--ros-args -r __ns:=/b -r a:=b",
        "2.0",
        "--ros-args -p speed:=2.0 -r a:=b",
        "--ros-args -r __ns:=/x | --ros-args -r __node:=m -r __ns:=/",
    ]


GIVEN = (
    NODE
    + """
from typing import List
from launch.conditions import IfCondition
from rclpy._rcl.ros_args import parse_ros_args
for each in ('n', 'flag', 'words', 'numbers', 'nothing', 'bad'):
    context.launch_configurations[each] = {'n': '3', 'flag': 'false', 'words': 'a: b', 'numbers': '[1, 2]',
        'nothing': '', 'bad': '['}[each]
def of(name):
    return LaunchConfiguration(name)
def given(parameters, **node):
    args(parameters=parameters, **node)
    parsed = parse_ros_args(context.started[-1][2].arguments, reject_unknown=True)
    for pattern, values in parsed.parameters.items():
        print(pattern, {name: value.get() for name, value in values.items()})
"""
)


@pytest.mark.parametrize(
    ("value", "read"),
    [
        ("ParameterValue(of('flag'), value_type=bool)", "False"),
        ("ParameterValue(of('flag'))", "False"),
        ("ParameterValue(of('n'))", "3"),
        ("ParameterValue(of('n'), value_type=float)", "3.0"),
        ("ParameterValue(of('n'), value_type=str)", "'3'"),
        ("ParameterValue(of('words'), value_type=str)", "'a: b'"),
        ("ParameterValue(of('numbers'), value_type=List[int])", "[1, 2]"),
        ("ParameterValue([[of('n')], 4], value_type=List[int])", "[3, 4]"),
        ("ParameterValue([1, 2], value_type=List[float])", "[1.0, 2.0]"),
        ("ParameterValue('x')", "'x'"),
        ("of('flag')", "False"),
        ("of('numbers')", "[1, 2]"),
        ("of('nothing')", "''"),
        ("'1.0'", "'1.0'"),
        ("'yes'", "'yes'"),
        ("'two\\nlines'", "'two\\nlines'"),
        ("[1, 2.5]", "[1.0, 2.5]"),
        ("[1e-20, 1.0]", "[1e-20, 1.0]"),
        ("['a', of('n')]", "'a3'"),
        ("[['a', of('n')], 'b']", "['a3', 'b']"),
        ("['a', 'yes']", "['a', 'yes']"),
        ("(True, False)", "[True, False]"),
    ],
)
def test_a_parameter_is_what_launch_makes_of_its_value(run_script: RunScript, value: str, read: str) -> None:
    run = visited(run_script, f"{GIVEN}given([{{'p': {value}}}])")
    assert lines(run) == [f"/** {{'p': {read}}}"]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("ParameterValue(of('n'), value_type=bool)", "ValueError: Cannot convert value '3' to '<class 'bool'>'"),
        ("ParameterValue(of('flag'), value_type=int)", "ValueError: invalid literal for int()"),
        ("ParameterValue(of('n'), value_type=List[int])", "Cannot convert value '3' to a list of '<class 'int'>'"),
        ("ParameterValue(of('bad'))", "ValueError: Failed to convert '[' using yaml rules: yaml.safe"),
        ("ParameterValue(1, value_type=str)", "TypeError: value='1' is not an instance of <class 'str'>"),
        ("ParameterValue([1, 'a'])", "TypeError: Input value is not an acceptable 'SomeValueType'.Got value='[1"),
        ("of('words')", "Sequence[float], Sequence[str]. Got <class 'dict'>.If the parameter is meant"),
        ("of('bad')", "TypeError: Unable to parse the value of parameter p as yaml. If the parameter is meant"),
        ("[1, 'a']", "TypeError: Expected a non-empty sequence, with items of uniform type."),
        ("None", "TypeError: Unexpected type for parameter value None"),
        ("[]", "TypeError: Expected 'value' to be one of"),
    ],
)  # fmt: skip
def test_a_value_that_no_parameter_can_have_is_refused(run_script: RunScript, value: str, said: str) -> None:
    assert said in visited(run_script, f"{GIVEN}given([{{'p': {value}}}])").stderr


def test_parameters_of_a_node_are_for_its_name_where_that_is_known(run_script: RunScript) -> None:
    run = visited(
        run_script,
        f"""{GIVEN}
from launch_ros.descriptions import Parameter as Described
given([{{}}])
given([{{'a': {{'b': 1}}, ('c', of('n')): 2}}], name='n', namespace='/x')
given([{{'a': 1}}, Described('b', of('n')), Described('c', 'd')], name='n')
context.launch_configurations['global_params'] = []
said(SetParameter('s', [1, 2]), SetParameter('t', of('n')), SetParameter('u', '1'))
given([Described('t', 4)])
""",
    )
    assert lines(run) == [
        "/x/n {'a.b': 1, 'c3': 2}",
        "/** {'a': 1, 'b': 3, 'c': 'd'}",
        "/** {'s': '(1, 2)', 't': 4, 'u': 1}",
    ]


SUBSTITUTED = """
open('/tmp/a.yaml', 'w').write(TEXT)
print(open(ParameterFile('/tmp/a.yaml', allow_substs=True).evaluate(context)).read())
"""


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("a: $(var n)", "a: 3"),
        ("a: $(var none 5)", "a: 5"),
        ("a: $(env NONE '')/$(env NONE a$(var n)b)", "a: /a3b"),
        ('a: $(eval "$(var n) * 2")', "a: 6"),
        (r"""a: $(env NONE "b$(env NONE \"c'd\")")""", '''a: b"c'd"'''),
        ("a: $(not $(var flag))", "a: true"),
        ("a: $5 (b)", "a: $5 (b)"),
        (r"a: \$(var n)", "a: $(var n)"),
        ("", ""),
    ],
)
def test_substitutions_in_a_file_of_parameters(run_script: RunScript, text: str, read: str) -> None:
    assert lines(visited(run_script, f"{GIVEN}TEXT = {text!r}{SUBSTITUTED}")) == [read]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: $(nothing)", "RuntimeError: Unknown substitution: nothing"),
        ("a: $(var)", "TypeError: var substitution expects 1 or 2 arguments"),
        ("a: $(var n", "ValueError: "),
        ("a: $(var none)", "SubstitutionFailure: launch configuration 'none' does not exist"),
        ("a: [$(var n)", "SubstitutionFailure: The substituted parameter file is not a valid yaml file"),
    ],
)
def test_a_wrong_substitution_in_a_file_is_refused(run_script: RunScript, text: str, said: str) -> None:
    assert said in visited(run_script, f"{GIVEN}TEXT = {text!r}{SUBSTITUTED}").stderr


def test_a_namespace_that_cannot_be_one_is_refused(run_script: RunScript) -> None:
    run = visited(run_script, "said(PushRosNamespace('1a'))")
    assert "SubstitutionFailure: The resulting namespace is invalid" in run.stderr


def test_what_is_not_carried_out_is_kept_in_mind(run_script: RunScript) -> None:
    run = visited(
        run_script,
        """
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
node = LifecycleNode(package='p', executable='e', name='n', namespace='', respawn=True)
said(
    RegisterEventHandler(OnProcessIO(target_action=node, on_stdout=lambda event: text('heard'))),
    RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, entities=[text('changed')])),
    EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=1)),
    EmitEvent(event=process.ShutdownProcess(process_matcher=matches_action(node))),
    ComposableNodeContainer(package='rclcpp_components', executable='component_container', name='c', namespace='',
        composable_node_descriptions=[ComposableNode(package='q', plugin='q::Talker')]),
    node, Node(package='robot_state_publisher', executable='r', parameters=[{'d': Command('xacro a')}]),
)
print(*context.untold, sep='\\n')
print([each[1] for each in context.started], node.untold(), node.node_name)
""",
    )
    assert lines(run) == [
        "OnProcessIO",
        "OnStateTransition",
        "ChangeState",
        "ShutdownProcess",
        "the component q::Talker of q",
        "robot_state_publisher r: no command can be run here: xacro a",
        "['node', 'node'] ['respawn'] /n",
    ]


def test_a_timer_wants_a_float(run_script: RunScript) -> None:
    assert (
        "'TimerAction' expected 'period' to be one of"
        in visited(run_script, "RosTimer(period=1, actions=[])").stderr
    )
