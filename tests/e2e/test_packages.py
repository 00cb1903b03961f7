"""Packages graded by the real sandbox: what ros2 run would start drives, and fails as it does at home."""

from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Assignment, WantedPackage
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.formats.packages.bundle import bundled
from grader.grading.slot import Slot
from tests.e2e.grading_slot import catalog
from tests.fakes.packages import DRIVE, HELPER, NAME, package_files, zipped

MODULE = f"{NAME}/drive.py"
ALONE = HELPER + DRIVE.format(name=NAME).replace(f"from {NAME}.helper import forward\n", "") + "\n\nmain()\n"


def assignment(wanted: WantedPackage | None = None) -> Assignment:
    return replace(catalog().get("straight"), input="package", package=wanted)


def graded(slot: Slot, files: dict[str, str], wanted: WantedPackage | None = None) -> GradeReport:
    job = GradingJob(file_name="p.zip", source=bundled(zipped(files)), assignment=assignment(wanted))
    return slot.grade(job).report


def test_a_package_drives_as_its_code_in_one_file(slot: Slot) -> None:
    script = GradingJob(file_name="a.py", source=ALONE.encode(), assignment=catalog().get("straight"))
    alone = slot.grade(script)
    package = graded(slot, package_files())
    assert package.score == alone.report.score == 100
    assert package.runs[0].trajectory_sha256 == alone.report.runs[0].trajectory_sha256
    assert package == graded(slot, package_files())


def test_an_error_names_the_file_it_is_in(slot: Slot) -> None:
    broken = HELPER.replace("msg.linear.x = speed", "msg.linear.xx = speed")
    report = graded(slot, package_files(**{f"{NAME}/helper.py": broken}))
    error = report.runs[0].outcome.error
    assert error is not None
    assert (error.file, error.line) == (f"{NAME}/{NAME}/helper.py", 6)
    assert f'File "{NAME}/{NAME}/drive.py", line 15, in tick' in error.traceback


PRINTS = """import os
import sys
from {name}.helper import forward
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

def main():
    print(__name__, __file__, sys.argv)
    share = get_package_share_directory('{name}')
    print(share, os.listdir(share), os.getcwd(), os.listdir('.'))
    print(open(os.path.join(share, 'config', 'a.yaml')).read().strip())
    print(open('src/{name}/config/a.yaml').read().strip())
    try:
        get_package_share_directory('nothing')
    except PackageNotFoundError as error:
        print(error)
    return 3
"""


def test_a_module_finds_itself_and_its_files_where_colcon_installs_them(slot: Slot) -> None:
    files = package_files(**{MODULE: PRINTS.format(name=NAME), "config/a.yaml": "x: 1\n"})
    outcome = graded(slot, files).runs[0].outcome
    prefix = f"/home/student/ros2_ws/install/{NAME}"
    assert outcome.stdout.text.splitlines() == [
        f"{NAME}.drive {prefix}/lib/python3.10/site-packages/{NAME}/drive.py ['{prefix}/lib/{NAME}/drive']",
        f"{prefix}/share/{NAME} ['package.xml', 'config'] /home/student/ros2_ws ['src', 'install']",
        "x: 1",
        "x: 1",
        f"\"package 'nothing' not found, searching: ['{prefix}', '/opt/ros/humble']\"",
    ]
    assert outcome.exit_code == 3


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"setup.cfg": None}, "No executable found"),
        ({"setup.cfg": "[install]\ninstall_scripts=$base/bin\n"}, "No executable found"),
        ({f"{NAME}/__init__.py": None}, "ModuleNotFoundError: No module named 'my_turtle'"),
        ({MODULE: None}, "ModuleNotFoundError: No module named 'my_turtle.drive'"),
        ({MODULE: "def mian(): pass\n"}, "AttributeError: module 'my_turtle.drive' has no attribute 'main'"),
        ({MODULE: "def main(:\n"}, "SyntaxError: invalid syntax"),
        ({f"resource/{NAME}": None}, "No executable found"),
        ({"package.xml": "<package><name>my_turtle</name></package>"}, "No executable found"),
    ],
)
def test_a_broken_package_fails_as_ros2_run_does(
    slot: Slot, changed: dict[str, str | None], said: str
) -> None:
    report = graded(slot, package_files(**changed))
    outcome = report.runs[0].outcome
    assert said in outcome.stderr.text
    assert outcome.exit_code == 1
    assert report.score == 0


def test_setup_is_never_run(slot: Slot, tmp_path: Path) -> None:
    setup = package_files()[f"{NAME}/setup.py"]
    trap = tmp_path / "ran"
    evil = f"open({str(trap)!r}, 'w')\nimport os\nos._exit(1)\nwhile True: pass\n"
    assert graded(slot, package_files(**{"setup.py": evil + setup})).score == 100
    assert not trap.exists()


LAUNCH = """import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, LogInfo, RegisterEventHandler, TimerAction
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessStart
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare('my_turtle'), 'config', 'a.yaml'])
    sim = Node(package='turtlesim', executable='turtlesim_node', name='sim')
    mover = Node(
        package='my_turtle', executable='drive', name='mover', output='screen',
        parameters=[config, {'distance': LaunchConfiguration('distance'), 'note': '1.0', 'list': [1, 2]}],
        remappings=[('/cmd', '/turtle1/cmd_vel')], arguments=['--fast'],
    )
    never = Node(package='my_turtle', executable='drive', condition=IfCondition(LaunchConfiguration('two')))
    return LaunchDescription([
        DeclareLaunchArgument('distance', default_value='3.5'),
        DeclareLaunchArgument('two', default_value='false'),
        LogInfo(msg=['distance ', LaunchConfiguration('distance')]),
        sim, never,
        ExecuteProcess(cmd=['ros2', 'topic', 'list']),
        RegisterEventHandler(
            OnProcessStart(target_action=sim, on_start=[TimerAction(period=1.5, actions=[mover])])
        ),
    ])
"""
LAUNCHED = """import sys
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


def main():
    rclpy.init()
    node = Node('drive')
    defaults = {'speed': 0.0, 'distance': 0.0, 'note': ''}
    values = [node.declare_parameter(name, value).value for name, value in defaults.items()]
    print(node.get_fully_qualified_name(), values, node.declare_parameter('list', [0]).value, sys.argv[1])
    pub = node.create_publisher(Twist, '/cmd', 10)
    msg = Twist()
    msg.linear.x = values[0]
    node.create_timer(0.1, lambda: pub.publish(msg))
    rclpy.spin(node)
"""
LAUNCHING = WantedPackage(launch="go.launch.py")


def launched(slot: Slot, launch: str, **changed: str) -> GradeReport:
    files = {MODULE: LAUNCHED, "config/a.yaml": "mover:\n  ros__parameters:\n    speed: 1.25\n", **changed}
    return graded(slot, package_files(**files, **{"launch/go.launch.py": launch}), LAUNCHING)


def test_a_launch_file_with_one_node_of_its_own_is_carried_out(slot: Slot) -> None:
    report = launched(slot, LAUNCH)
    outcome = report.runs[0].outcome
    assert outcome.stdout.text.splitlines() == [
        "[INFO] [launch.user]: distance 3.5",
        "/mover [1.25, 3.5, '1.0'] [1, 2] --fast",
    ]
    assert report.score == 100
    assert outcome.first_command_ns is not None
    assert 1_600_000_000 < outcome.first_command_ns < 1_700_000_000
    assert [(note.code, note.text) for note in outcome.notes if note.code.startswith("launch")] == [
        ("launch_ignored", "turtlesim_node -r __node:=sim"),
        ("launch_ignored", "ros2 topic list"),
    ]


@pytest.mark.parametrize(
    ("launch", "said"),
    [
        (LAUNCH.replace("[mover]", "[]"), "starts no node of your own package"),
        (LAUNCH.replace("generate_launch", "generate_lunch"), "does not contain the required function"),
        (
            LAUNCH.replace("executable='drive', name", "executable='dirve', name"),
            "executable 'dirve' not found on the",
        ),
        (LAUNCH.replace("remappings=[(", "remapping=[("), "unexpected keyword argument 'remapping'"),
        (LAUNCH.replace("default_value='3.5'", "default_value=3.5"), "'float' object is not iterable"),
        (LAUNCH.replace("'--fast'", "'--fast', 2"), "'int' object is not iterable"),
        (LAUNCH.replace("period=1.5", "period=1"), "expected 'period' to be one of"),
        (LAUNCH.replace("msg=['distance ', ", "msg=['distance ', 3.5, "), "Failed to normalize given item"),
        (LAUNCH.replace("default_value='3.5'", "description='x'"), "Required launch argument 'distance'"),
        (
            LAUNCH.replace("FindPackageShare('my_turtle')", "FindPackageShare('mine')"),
            "package 'mine' not found",
        ),
        (LAUNCH.replace("    sim =", "    sin =", 1), "NameError: name 'sim' is not defined"),
    ],
)
def test_a_wrong_launch_file_is_told(slot: Slot, launch: str, said: str) -> None:
    assert launch != LAUNCH
    report = launched(slot, launch)
    assert said in report.runs[0].outcome.stderr.text
    assert report.score == 0


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ("executable='drive', name", "executable='dirve', name", "launch_executable", "the executable dirve"),
        ("remappings=[(", "remapping=[(", "launch_keyword", "no argument remapping"),
        (
            "package='my_turtle', executable=",
            "package='my_turtle', node_executable=",
            "launch_no_executable",
            "has no executable",
        ),
        (
            "my_turtle', executable='drive', name",
            "my_turtle', name",
            "launch_no_executable",
            "has no executable",
        ),
        ("drive', name='mover'", "drive', node_name='mover'", "launch_keyword", "no argument node_name"),
        ("package='my_turtle', exec", "package='my_turtel', exec", "unknown_package", "no package my_turtel"),
        ("default_value='3.5'", "default_value=3.5", "launch_number", "in quotes"),
        ("msg=['distance ', ", "msg=['distance ', 3.5, ", "launch_number", "in quotes"),
        ("period=1.5", "period=1", "launch_period", "period=2.0"),
        ("    return Launch", "    Launch", "launch_returns_nothing", "return LaunchDescription"),
        (
            "default_value='3.5'",
            "default_value='3'",
            "parameter_integer",
            "distance is declared as a decimal",
        ),
        ("    sim =", "    for each in 3: pass\n    sim =", "not_iterable", "range(4)"),
    ],
)
def test_the_hint_says_what_is_wrong_in_a_launch_file(
    slot: Slot, old: str, new: str, code: str, words: str
) -> None:
    report = launched(slot, LAUNCH.replace(old, new, 1))
    assert (report.mistakes[0], words in report.hint.en) == (code, True), report.hint.en


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("import IfCondition", "import IfConditions"),
        ("launch.conditions", "launch.conditoins"),
        ("import os\n", "import cv2\n"),
        ("import os\n", "import helper\n"),
    ],
)
def test_a_missing_import_of_a_launch_file_is_told_and_not_that_it_is_no_node(
    slot: Slot, old: str, new: str
) -> None:
    report = launched(slot, LAUNCH.replace(old, new, 1))
    assert report.mistakes[0] in ("library_not_here", "missing_module"), report.hint.en
    assert "launch/go.launch.py" in report.hint.en
    assert "not a node" not in report.hint.en


def test_an_error_outside_the_students_lines_is_told_without_a_line(slot: Slot) -> None:
    report = launched(slot, LAUNCH.replace("generate_launch", "generate_lunch"))
    assert report.mistakes == ("crashed",)
    assert "?" not in report.hint.en + report.hint.zh


def test_a_launch_file_that_is_not_installed_is_not_found(slot: Slot) -> None:
    setup = package_files()[f"{NAME}/setup.py"].replace("glob('launch/*.launch.py')", "[]")
    report = launched(slot, LAUNCH, **{"setup.py": setup})
    assert "was not found in the share directory of package 'my_turtle'" in report.runs[0].outcome.stderr.text
    assert report.mistakes[0] == "package_launch_missing"


def test_that_a_node_is_started_again_is_listed_as_ignored(slot: Slot) -> None:
    outcome = launched(slot, LAUNCH.replace("output='screen'", "respawn=True")).runs[0].outcome
    assert [note.text for note in outcome.notes if note.code == "launch_ignored"] == [
        "turtlesim_node -r __node:=sim",
        "ros2 topic list",
        "respawn of my_turtle drive",
    ]


def test_what_comes_when_a_node_starts_late_comes_later_still(slot: Slot) -> None:
    late = LAUNCH.replace("sim, never,", "TimerAction(period=2.0, actions=[sim]), never,")
    first_ns = launched(slot, late).runs[0].outcome.first_command_ns
    assert first_ns is not None
    assert 3_600_000_000 < first_ns < 3_700_000_000


def test_a_file_of_parameters_that_is_not_there_is_left_out_with_a_warning(slot: Slot) -> None:
    report = launched(slot, LAUNCH.replace("'a.yaml'", "'b.yaml'"))
    outcome = report.runs[0].outcome
    assert "Parameter file path is not a file: /home/student" in outcome.stderr.text
    assert "/mover [0.0, 3.5, '1.0']" in outcome.stdout.text


INCLUDES = """from launch import LaunchDescription
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution, ThisLaunchFileDir
from launch_ros.actions import PushRosNamespace

def generate_launch_description():
    inner = PythonLaunchDescriptionSource(PathJoinSubstitution([ThisLaunchFileDir(), 'inner.launch.py']))
    return LaunchDescription([GroupAction([
        PushRosNamespace('team'),
        IncludeLaunchDescription(launch_description_source=inner, launch_arguments={'distance': '9.0'}.items()),
    ], scoped=False)])
"""


def test_a_launch_file_includes_another(slot: Slot) -> None:
    outcome = launched(slot, INCLUDES, **{"launch/inner.launch.py": LAUNCH}).runs[0].outcome
    assert "/team/mover [0.0, 9.0, '1.0']" in outcome.stdout.text


def test_what_a_handler_starts_later_finds_nothing_of_a_group_that_has_ended(slot: Slot) -> None:
    group = INCLUDES.replace(", scoped=False", "")
    outcome = launched(slot, group, **{"launch/inner.launch.py": LAUNCH}).runs[0].outcome
    assert "launch configuration 'distance' does not exist" in outcome.stderr.text


BESIDE = """import os
import pkgutil
from importlib import resources

def main():
    here = os.path.dirname(__file__)
    print(open(os.path.join(here, 'data', 'a.txt')).read(), here.rpartition('/')[2])
    print(pkgutil.get_data('my_turtle', 'data/a.txt'))
    print(resources.files('my_turtle').joinpath('data/a.txt').read_text())
"""


def test_files_beside_the_modules_are_found(slot: Slot) -> None:
    setup = package_files()[f"{NAME}/setup.py"].replace(
        "data_files=[", "package_dir={'': '.'}, package_data={'my_turtle': ['data/*.txt']}, data_files=["
    )
    files = {MODULE: BESIDE, f"{NAME}/data/a.txt": "found", "setup.py": setup}
    outcome = graded(slot, package_files(**files)).runs[0].outcome
    assert outcome.stdout.text == "found my_turtle\nb'found'\nfound\n", outcome.stderr.text
