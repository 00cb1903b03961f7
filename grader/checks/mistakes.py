"""Mistakes that any script can make, recognised from how it ended and what it sent to the car.

`grader.messages.exceptions` knows what an exception means. The checks themselves recognise what went wrong in the
motion that they measure. Each code has a message ``mistake.<code>``.
"""

import difflib
import itertools
import math
import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from grader.checks.drive import Drive, is_drive, is_motion, moves_of, with_ends
from grader.checks.listening import topics_of, waits_in_vain
from grader.checks.measure import Mistake, mistake
from grader.contracts.assignment import ROBOT_TOPICS, World
from grader.contracts.outcome import Endpoint, RunOutcome, RunStatus, StudentError
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import COMMAND_LIFE_NS, Floats, Trajectory
from grader.geometry import exact
from grader.messages import join, say
from grader.messages.details import explained
from grader.messages.exceptions import meaning
from grader.messages.quantity import number

_IN_NOTE = re.compile(r"[^:]*?(?:\bline (\d{1,7}))?: (\w+)(?:: (.*))?", re.DOTALL | re.ASCII)
_SPACE = Text(zh="", en=" ")
_ENDINGS = {
    RunStatus.STALLED: "stalled",
    RunStatus.CPU_LIMIT: "cpu_limit",
    RunStatus.MEMORY_LIMIT: "memory_limit",
    RunStatus.FORBIDDEN: "forbidden",
    RunStatus.PROTOCOL: "forbidden",
}
TWIST = "geometry_msgs/msg/Twist"
_USAGE = 2  # argparse's exit code
_OWN_TOPICS = ("/rosout", "/parameter_events")  # every node publishes these
_OF_ROBOTS = ("/odom", "/tf", "/scan", "/imu", "/joint_states", "/camera/image_raw")
_SAME_M, _SAME_RAD = 0.01, 0.01
_TIMEOUT_SLACK_NS = 50_000_000
_OVERSLEPT_NS = 5_000_000_000
_CALL = re.compile(r"(?P<line>\d{1,7}) (?P<call>\S+) (?P<until_ns>\d{1,19})", re.ASCII)
_FOR_EVER_NS = 1 << 62  # when a wait without a deadline ends
_SWUNG_NS = 5_000_000_000
_FLIPS = 10
_STAYED_M, _SWUNG_RAD = 0.05, 0.02
_OF_PASTED = ("SyntaxError", "IndentationError", "NameError")
_MOST_LINES, _LONGEST_LINE = 1_000, 500
_TERMINAL = re.compile(
    r"Traceback \(most recent call last\):|\[(INFO|WARN|ERROR|FATAL|DEBUG)\] \[\d+\.\d+\] \[|>>> |"
    r"[\w.-]+@[\w.-]+:\S*[$#] |PS [A-Z]:\\\S*> |\$ (ros2|python3?|colcon|cd|source)\b|  File \".+\", line \d+, in "
)
TOO_BRIEF_NS = 50_000_000  # three updates of turtlesim


def script_mistakes(run: Run) -> tuple[Mistake, ...]:
    """Return the mistake that ended the script, or one of its threads, before its time, if any."""
    outcome, error = run.outcome, run.outcome.error
    pasted = terminal_line(run.source) if error is not None and error.type in _OF_PASTED else None
    if pasted is not None:
        return (mistake("terminal_output", line=pasted),)
    if outcome.status is RunStatus.CRASHED:
        return (Mistake(*meaning(error, "crashed")) if error is not None else _killed(outcome),)
    if outcome.status is RunStatus.SYNTAX_ERROR and error is not None:
        return (Mistake(*meaning(error, "syntax_error")),)
    if noted(outcome, "asks_again") is not None:
        return (mistake("asks_again"),)
    if outcome.status is RunStatus.OUTPUT_LIMIT:
        told = explained(outcome.status, outcome.detail)
        return (mistake("output_limit", amount=_amount(outcome), detail=told),)
    thread = noted(outcome, "thread_exception")  # what a thread was to do may be waited for in vain
    if thread is not None and outcome.status in (
        RunStatus.STALLED,
        RunStatus.FINISHED,
        RunStatus.INTERRUPTED,
    ):
        told = say("mistake.thread_crashed", detail=thread)
        reason = _reason(thread)
        return (Mistake("thread_crashed", told if reason is None else join([told, reason], _SPACE)),)
    if outcome.status in _ENDINGS:
        code = _ENDINGS[outcome.status]
        return (mistake(code, detail=explained(outcome.status, outcome.detail)),)
    return ()


def terminal_line(source: str) -> int | None:
    """Return the first line of a script that a terminal has printed, and nobody writes: a prompt, a log."""
    lines = source.split("\n", _MOST_LINES)[:_MOST_LINES]
    return next(
        (number for number, line in enumerate(lines, 1) if _TERMINAL.match(line[:_LONGEST_LINE])), None
    )


def _amount(outcome: RunOutcome) -> Text:
    """Return how many lines were printed by when; nothing where that differs from run to run."""
    kept = outcome.stdout.text + outcome.stderr.text
    size = len(kept.encode())
    if not size:
        return EMPTY
    dropped = outcome.stdout.dropped_bytes + outcome.stderr.dropped_bytes
    lines = kept.count("\n") * (size + dropped) / size
    rounded = round(lines, -2) if lines >= 1_000 else round(lines)  # the middle was not kept
    return say("detail.printed", lines=f"{rounded:.0f}", time=number(outcome.duration_ns / 1e9, "s", 3))


def noted(outcome: RunOutcome, code: str) -> str | None:
    """Return the text of the first note of that code, or None."""
    return next((note.text for note in outcome.notes if note.code == code), None)


def _reason(note: str) -> Text | None:
    """Return what the exception in a note means; None where that is not known."""
    match = _IN_NOTE.fullmatch(note)
    if match is None:
        return None
    error = StudentError(type=match[2], message=match[3] or "", line=int(match[1] or 0) or None, traceback="")
    code, reason = meaning(error, "crashed")
    return None if code == "crashed" else reason


def _killed(outcome: RunOutcome) -> Mistake:
    return mistake("killed", signal=outcome.signal or "?")


def command_mistakes(
    run: Run, world: World, *, turns: tuple[str, ...], drives: tuple[str, ...]
) -> tuple[Mistake, ...]:
    """Return why the car got no commands, or stopped obeying them.

    `turns` are the measures that a turn spoils when it ends too early, `drives` those that a drive spoils.
    """
    if world.kind == "robot":
        return robot_mistakes(run, world)
    outcome, topic = run.outcome, world.cmd_vel_topic
    if _teleports(run.trajectory):
        return (mistake("teleported", topic=topic),)
    killed = any(
        endpoint.kind == "client" and endpoint.name == "/kill" and endpoint.count
        for endpoint in run.outcome.endpoints
    )
    stood = float(np.ptp(run.trajectory.x_m)) < _SAME_M > float(np.ptp(run.trajectory.y_m))
    if killed and stood:
        return (mistake("turtle_killed"),)
    if not moves_of(run.trajectory) and (missing := _unpublished(run, world)) is not None:
        return (missing,)
    if (found := _unfit_commands(run, world)) is not None:
        return found
    if (longest_ns := _longest_motion_ns(run.trajectory)) < TOO_BRIEF_NS:
        return (mistake("too_brief", longest=number(longest_ns / 1e6, "ms")),)
    return _timeouts(run.trajectory, outcome, turns, drives)


def only_turned(run: Run, spoilt: tuple[str, ...]) -> Iterator[Mistake]:
    """Recognise a car that was told to turn, and never to drive."""
    if noted(run.outcome, "lateral_command") is not None:
        return  # it was told to drive, but sideways
    moves = moves_of(run.trajectory)
    if moves and not any(command.v_mps for command in moves):
        yield swings(run, spoilt) or mistake("no_drive", spoilt)


def robot_mistakes(run: Run, world: World) -> tuple[Mistake, ...]:
    """Return why a robot got no commands, or the script nothing of its sensors."""
    outcome, topic = run.outcome, world.cmd_vel_topic
    usual = {world.topics.get(name, name): name for name in ROBOT_TOPICS}
    if (unfit := noted(outcome, "sensor_qos")) is not None:
        return (mistake("sensor_qos", topic=unfit),)
    if outcome.status is RunStatus.INTERRUPTED:
        own = {endpoint.name for endpoint in outcome.endpoints if endpoint.kind == "publisher"}
        unheard = (name for name in outcome.heard if name not in own | usual.keys() | {topic})
        moved = bool(moves_of(run.trajectory))
        unknown = next((name for name in unheard if not moved or _is_misspelt(name, usual)), None)
        if unknown is not None:
            return (mistake("topic_nowhere", topic=unknown, topics=", ".join(usual)),)
    return _unfit_commands(run, world) or ()


def _unfit_commands(run: Run, world: World) -> tuple[Mistake, ...] | None:
    """Return why no command moves anything, empty if that is known already; None if some commands do."""
    outcome, commands = run.outcome, run.trajectory.commands
    if outcome.command_count == 0:
        return _silence(run, world)
    if outcome.nonfinite_commands:
        return (mistake("nonfinite_commands", count=outcome.nonfinite_commands),)
    if noted(outcome, "lateral_command") is not None:
        return (mistake("sideways"),)
    if commands and not any(command.v_mps or command.w_radps for command in commands):
        return (waits_in_vain(run, world, surely=True) or error_caught(run) or _only_zeros(run),)
    return None


def _is_misspelt(topic: str, usual: Iterable[str]) -> bool:
    """Whether a topic that nobody publishes is similar to a robot's; a script may do without any other."""
    return bool(difflib.get_close_matches(topic, usual, 1, 0.75))


def _teleports(trajectory: Trajectory) -> bool:
    """Whether the script teleported the car instead of driving it.

    Teleports before the first command choose where to start, and those back to the start pose are resets. Of the
    others one is allowed among commands, none in a script without commands.
    """
    begins_ns = trajectory.commands[0].t_ns if trajectory.commands else 0
    poses = np.column_stack((trajectory.x_m, trajectory.y_m, trajectory.heading_rad))
    jumps = [
        i
        for i in trajectory.jumps
        if int(trajectory.t_ns[i]) >= begins_ns
        and _apart(poses[i - 1], poses[i])
        and _apart(poses[0], poses[i])
    ]
    return len(jumps) > (1 if trajectory.commands else 0)


def _apart(one: Floats, other: Floats) -> bool:
    """Whether two poses (x, y in m, heading in rad) differ."""
    turned = math.remainder(float(other[2] - one[2]), math.tau)
    return (
        exact.hypot(float(other[0] - one[0]), float(other[1] - one[1])) > _SAME_M or abs(turned) > _SAME_RAD
    )


def asleep(run: Run) -> Iterator[Mistake]:
    """Recognise a sleep that outlasts the run by far, if the car was moving or had not been commanded yet.

    After a stop, or after a crash in another thread, a long sleep only keeps the program alive.
    """
    slept, commands = sleep_at_end(run), run.trajectory.commands
    if slept is None or (commands and not is_motion(commands[-1])):
        return
    if run.outcome.duration_ns + _OVERSLEPT_NS <= slept.until_ns < _FOR_EVER_NS:
        yield sleeps_too_long(run, slept)


class WaitingCall(NamedTuple):
    """A call that the main thread was waiting in: on which line, of what, and until when it would have waited."""

    line: int
    name: str
    until_ns: int


def call_at_end(run: Run) -> WaitingCall | None:
    """Return the call that the main thread was waiting in when the run was interrupted at the horizon."""
    found = _CALL.fullmatch(run.at_horizon)
    return None if found is None else WaitingCall(int(found["line"]), found["call"], int(found["until_ns"]))


def sleep_at_end(run: Run) -> WaitingCall | None:
    """Return the call of a ``sleep`` that the main thread was waiting in at the horizon."""
    call = call_at_end(run)
    return call if call is not None and call.name.endswith("sleep") else None


def sleeps_too_long(run: Run, slept: WaitingCall) -> Mistake:
    """Return the mistake of a sleep that outlasted the run."""
    until, end = number(slept.until_ns / 1e9, "s"), number(run.outcome.duration_ns / 1e9, "s")
    return mistake("sleeps_too_long", line=slept.line, until=until, end=end)


def time_was_up(run: Run, drive: Drive, spoilt: tuple[str, ...]) -> Iterator[Mistake]:
    """Recognise a car that was still on its way at the horizon: too slow, or what should end a part never came."""
    if drive.cut_short:
        yield mistake("time_was_up", spoilt, time=number(run.outcome.duration_ns / 1e9, "s"))


def swings(run: Run, spoilt: tuple[str, ...]) -> Mistake | None:
    """Recognise a listening script whose car only turned left and right in the end, each time too far."""
    track, since_ns = run.trajectory, run.outcome.duration_ns - _SWUNG_NS
    if run.outcome.status is not RunStatus.INTERRUPTED or not run.outcome.hears:
        return None
    last = track.t_ns >= since_ns
    turns = [
        command.w_radps
        for command in track.commands
        if command.t_ns >= since_ns and is_motion(command) and command.w_radps
    ]
    flips = sum(before * after < 0.0 for before, after in itertools.pairwise(turns))
    if (
        flips < _FLIPS
        or exact.hypot(float(np.ptp(track.x_m[last])), float(np.ptp(track.y_m[last]))) > _STAYED_M
    ):
        return None
    heading_rad = track.heading_rad[last]
    if float(np.ptp(heading_rad)) < _SWUNG_RAD:
        return None
    middle = number(math.remainder(math.degrees(exact.mean(heading_rad)), 360.0), "deg")
    return mistake("swings", spoilt, seconds=number(_SWUNG_NS / 1e9, "s"), times=flips, heading=middle)


def driving_mistakes(run: Run, own: Iterable[Mistake]) -> tuple[Mistake, ...]:
    """Return what probably went wrong in a drive, the likeliest cause first.

    What ended the script, or what it slept through, comes before the check's `own` mistakes. Each check
    decides where `command_mistakes` stands among its own.
    """
    return (*script_mistakes(run), *asleep(run), *own)


def without_node(run: Run) -> Mistake:
    """Return why a script that ended by itself has no node."""
    if run.outcome.stdout.text.strip():
        return mistake("only_printed")
    return mistake("nothing_ran")


def _unpublished(run: Run, world: World) -> Mistake | None:
    """Recognise a script that never ended and listens to what robots publish and turtlesim does not."""
    if world.odometry or run.outcome.status is not RunStatus.INTERRUPTED:
        return None
    published = {endpoint.name for endpoint in run.outcome.endpoints if endpoint.kind == "publisher"}
    missing = next((name for name in run.outcome.heard if name in _OF_ROBOTS and name not in published), None)
    return (
        None
        if missing is None
        else mistake("topic_nowhere", topic=missing, topics=", ".join(topics_of(world)))
    )


def error_caught(run: Run) -> Mistake | None:
    """Return the mistake of an error that something caught, in a script that nothing else ended."""
    error = noted(run.outcome, "caught")
    if error is None or script_mistakes(run):
        return None
    reason = _reason(error)
    if reason is None:
        return mistake("error_caught", detail=error)
    return Mistake("error_caught", join([say("detail.error_caught"), reason], _SPACE))


def _elsewhere(publishers: list[Endpoint], outcome: RunOutcome, topic: str) -> Mistake:
    """Return what was sent to others than the car, if anything was."""
    twists = [publisher for publisher in publishers if publisher.type == TWIST]
    lost = [
        twist for twist in twists or publishers if twist.name not in outcome.heard
    ]  # not between own nodes
    used = _names(lost or twists or publishers)
    if not any(publisher.count for publisher in publishers):
        return mistake("nothing_sent", used=used, topic=topic)
    return mistake("wrong_topic", used=used, topic=topic) if twists else mistake("no_publisher", topic=topic)


def _silence(run: Run, world: World) -> tuple[Mistake, ...]:
    """Return why no velocity command arrived; nothing if the script ended before it could send one."""
    outcome, topic = run.outcome, world.cmd_vel_topic
    if (caught := error_caught(run)) is not None:
        return (caught,)
    made = [
        endpoint
        for endpoint in outcome.endpoints
        if endpoint.kind == "publisher" and endpoint.name not in _OWN_TOPICS
    ]
    publishers = [endpoint for endpoint in made if _may_command(endpoint, topic)]
    right = [publisher for publisher in publishers if publisher.name == topic]
    twists = [publisher for publisher in publishers if publisher.type == TWIST]
    if set(right) & set(twists):
        return _unused_publisher(run, world)
    if right:
        return (mistake("wrong_type", topic=topic, type=right[0].type, wanted=TWIST),)
    if publishers:
        return (_elsewhere(publishers, outcome, topic),)
    if outcome.status not in (RunStatus.FINISHED, RunStatus.INTERRUPTED):
        return ()
    if (call := noted(outcome, "forbidden")) is not None:
        return (mistake("forbidden", detail=explained(RunStatus.FORBIDDEN, call)),)
    if _is_usage(outcome):
        return (mistake("no_arguments"),)
    if outcome.nodes:
        vain = waits_in_vain(run, world, surely=True) if outcome.status is RunStatus.INTERRUPTED else None
        return (vain or mistake("no_publisher", topic=topic),)
    return (without_node(run),)


def _is_usage(outcome: RunOutcome) -> bool:
    """Whether argparse ended the script, which asks for arguments that it was not given."""
    return (
        outcome.exit_code == _USAGE and re.search(r"^usage: ", outcome.stderr.text, re.MULTILINE) is not None
    )


def _unused_publisher(run: Run, world: World) -> tuple[Mistake, ...]:
    outcome, topic = run.outcome, world.cmd_vel_topic
    if _is_usage(outcome):
        return (mistake("no_arguments"),)
    if noted(outcome, "incompatible_qos") == topic:
        return (mistake("incompatible_qos", topic=topic),)
    if outcome.status is RunStatus.FINISHED:
        ended = number(outcome.duration_ns / 1e9, "s")
        return (mistake("never_spun", ended=ended),)
    if outcome.status is RunStatus.INTERRUPTED and (vain := waits_in_vain(run, world)) is not None:
        return (vain,)
    if outcome.status is RunStatus.INTERRUPTED:
        if (typed := noted(outcome, "type_mismatch")) is not None:
            return (mistake("not_received", topic=typed),)
        return (mistake("never_published"),)
    return ()


def _may_command(publisher: Endpoint, topic: str) -> bool:
    """Whether commands were meant: a text on /chatter, a transform or an action's feedback are none."""
    kind, name = publisher.type, publisher.name
    return name == topic or kind.startswith(("geometry_msgs/", "turtlesim/msg/")) or "vel" in name.lower()


def _only_zeros(run: Run) -> Mistake:
    """Return why nothing but stops arrived."""
    if (topic := noted(run.outcome, "type_mismatch")) is not None:
        return mistake("not_received", topic=topic)
    return mistake("only_stops" if noted(run.outcome, "stopped_at_once") is None else "stopped_at_once")


def _longest_motion_ns(trajectory: Trajectory) -> int:
    """Return the longest time for which motions were commanded without a stop; the first that is not too brief."""
    longest_ns, begun_ns = 0, None
    for command, until_ns in with_ends(trajectory):
        if not (command.v_mps or command.w_radps):
            begun_ns = None
            continue
        begun_ns = command.t_ns if begun_ns is None else begun_ns
        longest_ns = max(longest_ns, until_ns - begun_ns)
        if longest_ns >= TOO_BRIEF_NS:
            break
    return longest_ns if trajectory.commands else COMMAND_LIFE_NS


def _names(publishers: Iterable[Endpoint]) -> str:
    return ", ".join(sorted({f"{publisher.name} ({publisher.type})" for publisher in publishers})[:4])


def _timeouts(
    trajectory: Trajectory, outcome: RunOutcome, turns: tuple[str, ...], drives: tuple[str, ...]
) -> tuple[Mistake, ...]:
    """Recognise motions that turtlesim cut short because the script published nothing for a second.

    The last of several different motions is left out: no later command shows how long it was meant to last, and
    after it the car stands still, as it should.
    """
    commands, moves = trajectory.commands, moves_of(trajectory)
    only = all(command[1:] == moves[0][1:] for command in moves)
    ends = [command.t_ns for command in commands[1:]] + [outcome.duration_ns if only else 0]
    cut = [
        (end_ns - command.t_ns, command)
        for command, end_ns in zip(commands, ends, strict=False)
        if end_ns - command.t_ns > COMMAND_LIFE_NS + _TIMEOUT_SLACK_NS and is_motion(command)
    ]
    if not cut:
        return ()
    spoilt = {name for _, command in cut for name in (drives if is_drive(command) else turns)}
    if not spoilt:
        return ()
    silence_ns = max(gap for gap, _ in cut)
    measures = tuple(name for name in (*drives, *turns) if name in spoilt)
    return (mistake("published_once", measures, times=len(cut), silence=number(silence_ns / 1e9, "s")),)
