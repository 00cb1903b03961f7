"""Scripts without much structure, with parameters and input, and the many ways a script can end."""

from math import pi, tau

from grader.contracts.outcome import RunStatus
from tests.styles.expectation import Expectation, drive
from tests.styles.ideal import Leg

INTERRUPTED = RunStatus.INTERRUPTED
CRASHED = RunStatus.CRASHED

EXPECTED = {
    "module_level": Expectation(plan=drive(0.0, *[(0.5, 2.0, 0.0), (0.9999, 0.0, pi / 2)] * 4)),
    "main_called_without_guard": Expectation(plan=(Leg(0.0, 3.0, -0.5),), exit_code=0),
    "main_never_called": Expectation(plan=(), stdout="", exit_code=0),
    "shutdown_in_callback": Expectation(
        plan=(Leg(0.1, 2.0, 0.0, 1.0),), stdout="after spin False\n", notes=("shutdown_in_callback",)
    ),
    "double_shutdown": Expectation(
        plan=(Leg(1.0, 1.0, 1.0),),
        status=CRASHED,
        error="RuntimeError",
        says=("RuntimeError: Context must be initialized before it can be shutdown",),
    ),
    # Its own handler replaces rclpy's: the context is alive after Ctrl+C and the stop goes out, too late.
    "own_sigint_handler": Expectation(
        plan=(Leg(0.0, 8.0, 0.5),),
        status=INTERRUPTED,
        horizon_s=8.0,
        stdout="signal 2\ncontext ok: True\n",
        exit_code=0,
    ),
    "stop_message_in_finally": Expectation(
        plan=(Leg(0.2, 7.8, 0.4),),
        status=INTERRUPTED,
        horizon_s=8.0,
        cleanup="RCLError",
        says=("Ctrl+C", "Failed to publish: publisher's context is invalid"),
    ),
    "stop_in_destructor": Expectation(plan=(Leg(0.0, 1.0, 1.0),), stdout="", exit_code=0),  # nothing stops it
    "argparse_script": Expectation(
        plan=drive(0.0, *[(1.0, 1.5, 0.0), (1.0, 0.0, tau / 3)] * 3),
        args=("--speed", "1.5", "-n", "3", "--ros-args", "-r", "__node:=renamed"),
        stdout="renamed argparse_script.py\n",
        exit_code=0,
    ),
    "input_distance": Expectation(
        plan=(Leg(0.0, 2.5 / 0.8, 0.8),), stdin="2.5\n0.8\n", stdout="距离? 速度? 走了 2.5 米\n"
    ),
    "stdin_commands": Expectation(
        plan=drive(0.0, (1.0, 1.0, 0.0), (0.5, 0.0, 1.0), (0.5, -1.0, 0.0), (0.5, 0.0, -1.0)),
        stdin="wwa\nsd\n",
    ),
    "parameters_ros_args": Expectation(
        plan=(Leg(0.1, 2.0, 0.5, -0.5),),
        status=INTERRUPTED,
        args=(
            *("--ros-args", "-r", "__node:=wugui", "-p", "speed:=0.5", "-p", "ticks:=20", "-p", "turn:=-0.5"),
            *("-p", "label:=abc", "-r", "cmd_vel:=/turtle1/cmd_vel"),
        ),
        says=("[wugui]: wugui 0.5 20 abc",),
    ),
    "parameter_callback": Expectation(
        plan=drive(0.1, (1.0, 1.0, 0.0), (1.0, 2.0, 0.0)), status=INTERRUPTED, says=("no reverse gear",)
    ),
    "namespace_relative_topic": Expectation(
        plan=(Leg(0.1, 1.5, 1.0),), status=INTERRUPTED, says=("[turtle1.mover]: /turtle1/cmd_vel",)
    ),
    "numpy_profile": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (pi / 2, 0.0, 1.0), (2.0, 1.0, 0.0))),
    "dataclass_plan": Expectation(plan=drive(0.0, (0.6, 1.0, 0.0), (1.0, 0.0, -1.0), (0.9, 1.0, 1.0))),
    "ok_loop_with_break": Expectation(plan=(Leg(0.0, 3.0, 0.7, 0.7),), exit_code=0),
    "inheritance": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (1.0, 0.0, 1.5708), (1.0, 1.0, 0.0))),
    "recursion": Expectation(
        plan=drive(
            0.0,
            *((0.5, 1.5, 0.0), (0.5, 0.0, 1.0), (0.5, 1.0, 0.0)),
            *((0.5, 0.0, 1.0), (0.5, 0.5, 0.0), (0.5, 0.0, 1.0)),
        )
    ),
    # The command before the crash, at 1.4 s, is held for its second.
    "int_to_float_crash": Expectation(
        plan=(Leg(0.0, 2.4, 1.0),),
        status=CRASHED,
        error="AssertionError",
        says=("line 13", "AssertionError: The 'x' field must be of type 'float'"),
        exit_code=1,
    ),
    "lone_rate_stalls": Expectation(plan=(Leg(0.0, 1.0, 1.0),), status=RunStatus.STALLED),
    "wrong_topic": Expectation(plan=(), exit_code=0),
    "logging_module": Expectation(
        plan=(Leg(0.0, 1.0, 0.0, 1.0),),
        stdout="done\n",
        says=("ERROR:AttributeError: 'Publisher' object has no attribute 'publsh'",),
    ),
    "log_file_asctime": Expectation(
        plan=drive(0.0, *[(1.0, 1.0, 0.0), (1.0, 0.0, 1.5708)] * 4), stdout="8 INFO v=1.0 w=0.00\n"
    ),
    # Saved by Windows' editor: a byte order mark, and lines that end in CR LF.
    "log_beside_the_script": Expectation(
        plan=drive(0.0, (2.0, 1.0, 0.0), (pi / 2, 0.0, 1.0), (1.0, 1.0, 0.0)), stdout="2 处\n"
    ),
    "clear_screen_menu": Expectation(
        plan=(Leg(0.0, 2.5, 0.8),),
        stdout="\x1b[32m海龟直行\x1b[0m\n" + "".join(f"\r进度 {n}/10" for n in range(1, 11)) + "\n",
    ),
    "plot_the_path": Expectation(
        plan=(), status=CRASHED, stdout="", error="ModuleNotFoundError", exit_code=1
    ),
    "copy_and_repr": Expectation(
        plan=drive(0.0, (1.0, 1.0, 0.0), (1.0, 1.0, 1.0)),
        stdout="False geometry_msgs.msg.Vector3(x=1.0, y=0.0, z=0.0)\n",
    ),
}
