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

from grader.checks.drive import is_drive, is_motion, moves_of, times_begun, with_ends
from grader.checks.listening import waits_in_vain
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
from grader.messages.script import NOT_ZERO, ScriptText

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
_POSE = "turtlesim/msg/Pose"
_BY_HEADING = r"\b(theta|yaw|heading)\)? ?[-+<>]|[-+<>]=? ?(abs\()?[\w.]*\b(theta|yaw|heading)\b"
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
_EXIT = r"^[ \t]*(sys\.|os\._?)?(exit|quit)\("
_ENDS_ITSELF = (
    r"\bSystemExit\b|\bexit\(|\bspin_(once|until)|^[ \t]+if\b.*\bshutdown\(|"
    r"\b(create_timer|Timer)\(.*\bshutdown\b"
)
"""What ends a program that has a `spin` on purpose, or whose end is no sign of an error."""
_WRONG_GUARD = re.compile(
    r"^if[ \t]+__name__[ \t]*==[ \t]*[\"'](?!__main__[\"'])([^\"'\n]{0,30})[\"']", re.MULTILINE
)
_UNAWAITED = re.compile(r"coroutine '(?:\w+\.)?(\w+)' was never awaited")
_ONE_CALL = 2  # commands that one call of a callback publishes
_GROWING = 5_000  # more commands than any script sends that does not make ever more of something
TOO_BRIEF_NS = 50_000_000  # three updates of turtlesim
MANY_MOTIONS = 40  # more than the sides and corners of any figure, driven twice


def script_mistakes(run: Run) -> tuple[Mistake, ...]:
    """Return the mistake that ended the script, or one of its threads, before its time, if any."""
    outcome, error, script = run.outcome, run.outcome.error, ScriptText(run.source)
    if outcome.status is RunStatus.CRASHED:
        return (Mistake(*meaning(error, "crashed", script)) if error is not None else _killed(outcome),)
    if outcome.status is RunStatus.SYNTAX_ERROR and error is not None:
        return (Mistake(*meaning(error, "syntax_error", script)),)
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
        return (
            Mistake("thread_crashed", _explained(say("mistake.thread_crashed", detail=thread), thread, run)),
        )
    if outcome.status in _ENDINGS:
        code = _ENDINGS[outcome.status]
        return (mistake(code, detail=explained(outcome.status, outcome.detail)),)
    return ()


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


def _explained(told: Text, note: str, run: Run) -> Text:
    """Return what is `told` of the exception in a note and, where it is known, what that exception means."""
    reason = _reason(note, run)
    return told if reason is None else join([told, reason], _SPACE)


def _reason(note: str, run: Run) -> Text | None:
    """Return what the exception in a note means; None where that is not known."""
    found = _IN_NOTE.fullmatch(note)
    if found is None:
        return None
    line = int(found[1] or 0) or None
    written = run.source.splitlines()[line - 1 : line] if line else []
    message = (found[3] or "").partition(". Did you mean: ")[0]
    behind = f"{found[2]}: {found[3]}\n"
    traceback = "".join(f'  File "script", line {line}\n    {text.strip()}\n{behind}' for text in written)
    error = StudentError(type=found[2], message=message, line=line, traceback=traceback)
    code, reason = meaning(error, "crashed", ScriptText(run.source))
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
    if (odd := _turtles_and_timers(run)) is not None:
        return (odd,)
    if not moves_of(run.trajectory) and (missing := _unpublished(run, world)) is not None:
        return (missing,)
    if (found := _unfit_commands(run, world)) is not None:
        return found
    if (longest_ns := _longest_motion_ns(run.trajectory)) < TOO_BRIEF_NS:
        if (motions := times_begun(map(is_motion, run.trajectory.commands))) > MANY_MOTIONS:
            return (mistake("stop_in_loop", times=motions),)
        return (mistake("too_brief", longest=number(longest_ns / 1e6, "ms")),)
    return _timeouts(run.trajectory, outcome, turns, drives)


def _turtles_and_timers(run: Run) -> Mistake | None:
    """Recognise a script that removes the turtle that is graded, or makes ever more timers."""
    killed = any(
        each.kind == "client" and each.name == "/kill" and each.count for each in run.outcome.endpoints
    )
    script = ScriptText(run.source)
    if killed and not moves_of(run.trajectory):
        lines = script.lines_with(r"\bKill\.Request\(|\bKill\b.*\bcreate_client|create_client\( ?Kill\b") or [
            1
        ]
        return mistake("turtle_killed", line=lines[-1])
    if run.outcome.command_count >= _GROWING:
        begins = [callback.begins for callback in script.callbacks("timer")]
        made = [line for line in script.lines_with(r"\bcreate_timer\(") if script.owner_of(line) in begins]
        if made and not script.lines_with(r"\.cancel\("):
            return mistake("timer_in_callback", line=made[0])
    return None


def only_turned(run: Run, spoilt: tuple[str, ...]) -> Iterator[Mistake]:
    """Recognise a car that was told to turn, and never to drive."""
    if noted(run.outcome, "lateral_command") is not None:
        return  # it was told to drive, but sideways
    moves = moves_of(run.trajectory)
    if moves and not any(map(is_drive, moves)):
        # the pose of a script that hears nothing belongs to a teleport
        place = r"\.theta\b|\borientation\b|(?<!linear)\.x ?[-+)]|[-+] ?[\w.]+(?<!linear)\.x\b"
        by_pose = run.outcome.hears and ScriptText(run.source).lines_with(place)
        yield swings(run, spoilt) or mistake("no_drive_by_pose" if by_pose else "no_drive", spoilt)


def robot_mistakes(run: Run, world: World) -> tuple[Mistake, ...]:
    """Return why a robot got no commands, or the script nothing of its sensors."""
    outcome, topic = run.outcome, world.cmd_vel_topic
    usual = {world.topics.get(name, name): name for name in ROBOT_TOPICS}
    if (unfit := noted(outcome, "sensor_qos")) is not None:
        return (mistake("sensor_qos", topic=unfit),)
    if outcome.status is RunStatus.INTERRUPTED:
        own = {one.name for one in outcome.endpoints if one.kind == "publisher"}
        unheard = (name for name in outcome.heard if name not in own | usual.keys() | {topic})
        moved = bool(moves_of(run.trajectory))
        unknown = next((name for name in unheard if not moved or _is_misspelt(name, usual)), None)
        if unknown is not None:
            return (mistake("robot_silent", topic=unknown, topics=", ".join(usual)),)
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
    if slept is not None and slept.until_ns >= _FOR_EVER_NS and _is_rate(run, slept):
        yield mistake("rate_without_spin", line=slept.line)
        return
    if slept is None or (commands and not is_motion(commands[-1])):
        return
    if run.outcome.duration_ns + _OVERSLEPT_NS <= slept.until_ns < _FOR_EVER_NS:
        yield sleeps_too_long(run, slept)


def _is_rate(run: Run, slept: "WaitingCall") -> bool:
    script = ScriptText(run.source)
    if script.lines_with(r"\bThread\("):
        return False  # it may spin, and the rate be a slow one
    return bool(script.lines_with(r"\bcreate_rate\(")) and slept.line in script.lines_with(r"\.sleep\( ?\)")


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


def _loop_at_end(run: Run, script: ScriptText) -> int | None:
    """Return the line of the ``while`` that the main thread was in at the horizon."""
    call = call_at_end(run)
    heads = [] if call is None else [*list(script.outwards(call.line))[:1], *script.heads_around(call.line)]
    return next((at for at, head in heads if re.match(r"[ \t]*while\b", head)), None)


def sleeps_too_long(run: Run, slept: WaitingCall) -> Mistake:
    """Return the mistake of a sleep that outlasted the run."""
    until, end = number(slept.until_ns / 1e9, "s"), number(run.outcome.duration_ns / 1e9, "s")
    return mistake("sleeps_too_long", line=slept.line, until=until, end=end)


def _behind_spin(run: Run) -> Mistake | None:
    """Recognise work behind a call of `spin`, which had not returned when the run ended."""
    call, script = call_at_end(run), ScriptText(run.source)
    if call is None or not call.name.endswith("spin"):
        return None
    if call.line in script.lines_with(r"\btarget ?= ?[\w.]*\bspin\("):
        return mistake("thread_called", line=call.line)
    around = {None, *(at for at, _ in script.outwards(call.line))}
    inside = script.function_around(call.line)
    for line in script.lines_with(r"\brclpy\.spin\("):
        if line > call.line and script.function_around(line) == inside and script.owner_of(line) in around:
            return mistake("second_spin", line=line, spin=call.line)
    if not script.works_after(call.line) or any(line < call.line for line in _working_callbacks(script)):
        return None  # with a callback the work may be meant to happen there, and only the stop stands behind
    return mistake("behind_spin", line=call.line)


def _working_callbacks(script: ScriptText) -> Iterator[int]:
    """Yield the lines that create timers and subscriptions, unless their callback only keeps what it is given."""
    begins = {callback.created: callback.begins for callback in script.callbacks("timer", "subscription")}
    for line in script.lines_with(r"\bcreate_(timer|subscription)\("):
        body = [text for _, text in script.body(begins[line])] if line in begins else []
        if not body or not all(re.match(r"self\.\w+ ?=(?!=) ?[\w.]+$|\"\"$|pass$", text) for text in body):
            yield line


def _spin_in_callback(run: Run) -> Mistake | None:
    """Recognise a callback that waits for a future, which only another callback of the same executor can bring."""
    call, script = call_at_end(run), ScriptText(run.source)
    known = None if call is None else re.search(r"\bspin(_once|_until_future_complete)?$", call.name)
    if call is None or known is None:
        return None
    name = script.function_around(call.line)
    called_back = name and script.lines_with(
        rf"\bcreate_(timer|subscription|service)\(.*\b{re.escape(name)}\b"
    )
    code = "spin_in_callback" if known[1] == "_until_future_complete" else "spin_in_spin"
    return mistake(code, line=call.line, call=f"rclpy.{known[0]}()") if called_back else None


def no_final_stop(run: Run, excess: str, spoilt: tuple[str, ...]) -> Mistake:
    """Return the mistake of a car that went on by `excess`, a distance or an angle, because nothing stopped it."""
    return mistake("no_final_stop", spoilt, excess=excess, publisher=ScriptText(run.source).publisher_name)


def swings(run: Run, spoilt: tuple[str, ...]) -> Mistake | None:
    """Recognise a listening script whose car only turned left and right in the end, each time too far."""
    track, since_ns = run.trajectory, run.outcome.duration_ns - _SWUNG_NS
    if run.outcome.status is not RunStatus.INTERRUPTED or not run.outcome.hears:
        return None
    last = track.t_ns >= since_ns
    turns = [one.w_radps for one in track.commands if one.t_ns >= since_ns and is_motion(one) and one.w_radps]
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
    if run.source and not ScriptText(run.source).has_code:
        return mistake("no_code")
    if ScriptText(run.source).lines_with(r"^def generate_launch_description\b"):
        return mistake("other_file", name="launch")
    if (guard := _WRONG_GUARD.search(run.source)) is not None:
        return mistake("main_guard", given=guard[1], line=run.source.count("\n", 0, guard.start()) + 1)
    if (uncalled := not_called(run)) is not None:
        return uncalled
    if (twice := defined_twice(run)) is not None:
        return twice
    if inside := ScriptText(run.source).lines_with(r"^[ \t]+if __name__ ?=="):
        return mistake("guard_inside", line=inside[0])
    exits = _exits(ScriptText(run.source), run.outcome)
    if exits and not run.outcome.stdout.text.strip():
        return mistake("exited_early", line=exits[0])
    if (line := _never_came_to_init(ScriptText(run.source))) is not None:
        return mistake("ended_before_init", line=line)
    if run.outcome.stdout.text.strip():
        return mistake("only_printed")
    return mistake("nothing_ran")


def _never_came_to_init(script: ScriptText) -> int | None:
    """Return the line of the only `init` in a script that ended before it, though the function around it runs."""
    lines = script.lines_with(r"\brclpy\.init\(")
    around = script.function_around(lines[0]) if len(lines) == 1 else ""
    return lines[0] if lines and around and around in _run_from_top(script) else None


def _run_from_top(script: ScriptText) -> set[str]:
    """Return the names of the functions that the module's own statements call, without those that these call."""
    calls = script.matches(r"(?<![\w.])(\w+)\(")
    return {
        found[1] for line, found in calls if not script.function_around(line) and "def " not in found.string
    }


def _unpublished(run: Run, world: World) -> Mistake | None:
    """Recognise a script that never ended and listens to what robots publish and turtlesim does not."""
    if world.odometry or run.outcome.status is not RunStatus.INTERRUPTED:
        return None
    published = {one.name for one in run.outcome.endpoints if one.kind == "publisher"}
    missing = next((name for name in run.outcome.heard if name in _OF_ROBOTS and name not in published), None)
    return None if missing is None else mistake("not_published", topic=missing)


def error_caught(run: Run) -> Mistake | None:
    """Return the mistake of an error that something caught, in a script that nothing else ended."""
    error = noted(run.outcome, "caught")
    if error is None or script_mistakes(run):
        return None
    reason = _reason(error, run)
    if reason is None:
        return mistake("error_caught", detail=error)
    return Mistake("error_caught", join([say("detail.error_caught"), reason], _SPACE))


def _elsewhere(publishers: list[Endpoint], outcome: RunOutcome, topic: str) -> Mistake:
    """Return what was sent to others than the car, if anything was."""
    twists = [each for each in publishers if each.type == TWIST]
    lost = [each for each in twists or publishers if each.name not in outcome.heard]  # not between own nodes
    if lost and all(each.type == _POSE for each in lost):
        return mistake("pose_published", used=lost[0].name, topic=topic)
    used = _names(lost or twists or publishers)
    if not any(each.count for each in publishers):
        return mistake("nothing_sent", used=used, topic=topic)
    return mistake("wrong_topic", used=used, topic=topic) if twists else mistake("no_publisher", topic=topic)


def _silence(run: Run, world: World) -> tuple[Mistake, ...]:
    """Return why no velocity command arrived; nothing if the script ended before it could send one."""
    outcome, topic = run.outcome, world.cmd_vel_topic
    if (caught := error_caught(run)) is not None:
        return (caught,)
    made = [each for each in outcome.endpoints if each.kind == "publisher" and each.name not in _OWN_TOPICS]
    publishers = [each for each in made if _may_command(each, topic)]
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
        return (
            vain
            or _spin_in_callback(run)
            or _behind_spin(run)
            or _not_reached(run, "Twist" if made else "")
            or mistake("no_publisher", topic=topic),
        )
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
        return (ended_at_once(run) or not_called(run) or mistake("never_spun", ended=ended),)
    if outcome.status is RunStatus.INTERRUPTED and (vain := waits_in_vain(run, world)) is not None:
        return (vain,)
    if outcome.status is RunStatus.INTERRUPTED and _others_publish(outcome, topic):
        nodes = sorted({each.node for each in outcome.endpoints if each.name == topic})
        return (mistake("node_never_published", nodes=", ".join(nodes), topic=topic),)
    if outcome.status is RunStatus.INTERRUPTED:
        stuck = _spin_in_callback(run) or _behind_spin(run) or _waits(run) or _other_spun(run)
        return (stuck or not_called(run) or _never_published(run),)
    return ()


def _other_spun(run: Run) -> Mistake | None:
    """Recognise a node that only another one is spun beside: the callbacks of its own never run."""
    script = ScriptText(run.source)
    spun = [(line, found[1]) for line, found in script.matches(r"\bspin\( ?(\w+) ?\)")]
    made = [found[1] for _, found in script.matches(rf"^[ \t]*(\w+) ?= ?{script.node_class}\(")]
    if len(spun) != 1 or len(made) != 1 or spun[0][1] == made[0] or script.lines_with(r"\badd_node\("):
        return None
    other = script.assigned(spun[0][1])
    is_node = other is not None and re.search(r"\b(create_node|Node)\(", other.value)
    return mistake("other_node_spun", line=spun[0][0], spun=spun[0][1], node=made[0]) if is_node else None


def _may_command(publisher: Endpoint, topic: str) -> bool:
    """Whether commands were meant: a text on /chatter, a transform or an action's feedback are none."""
    kind, name = publisher.type, publisher.name
    return name == topic or kind.startswith(("geometry_msgs/", "turtlesim/msg/")) or "vel" in name.lower()


def _others_publish(outcome: RunOutcome, topic: str) -> bool:
    """Whether there are other nodes, which published something: then a line with `publish` may be theirs."""
    own = [each for each in outcome.endpoints if each.name not in _OWN_TOPICS]
    commanding = {each.node for each in own if each.name == topic}
    others = any(each.count and each.kind == "publisher" and each.node not in commanding for each in own)
    return others or noted(outcome, "launch_several") is not None


def ended_at_once(run: Run) -> Mistake | None:
    """Recognise what ends a script that looks complete at once: a loop that never begins, an exit."""
    script = ScriptText(run.source)
    if lines := script.lines_with(r"\bwhile not rclpy\.ok\("):
        return mistake("not_ok", line=lines[0])
    if lines := script.lines_with(r"^[ \t]*rclpy\.spin$"):
        return mistake("only_named", line=lines[0], call="rclpy.spin(node)")
    spins = script.lines_with(r"\bspin\w*\(")
    if (lines := _exits(script, run.outcome)) and spins and lines[0] < spins[0]:
        return mistake("exited_early", line=lines[0])
    ends_itself = script.lines_with(_ENDS_ITSELF) or _ends_in_callback(script)
    asked = any(
        re.match(r"[ \t]*if\b(?!.*__name__)", head) for at in spins for head in script.conditions_around(at)
    )
    if spins and not asked and (caught := script.lenient_except) is not None and not ends_itself:
        return mistake("error_hidden", line=caught)
    return None


def _ends_in_callback(script: ScriptText) -> list[int]:
    """Return the lines that shut down in callbacks, and in functions that they call."""
    begins = script.reached_from(callback.begins for callback in script.callbacks("timer", "subscription"))
    inside = {line for first in begins for line in script.span(first)}
    return [line for line in script.lines_with(r"\bshutdown\(") if line in inside]


def _exits(script: ScriptText, outcome: RunOutcome) -> list[int]:
    """Return the lines that end the program, without those in functions that nothing calls.

    Where the program ended without an error, none that would have ended it with one.
    """
    lines = script.lines_with(_EXIT if outcome.exit_code else rf"{_EXIT} ?0? ?\)")
    found = ((number, script.function_around(number)) for number in lines)
    return [number for number, name in found if not name or script.calls(name)]


def _never_published(run: Run) -> Mistake:
    """Return why a node that ran to the horizon never published."""
    script = ScriptText(run.source)
    if (twice := defined_twice(run)) is not None:
        return twice
    publishes = script.lines_with(r"\.publish\(")
    fires = script.lines_with(r"\bcreate_timer\( ?(0?\.\d+|[1-5](\.\d*)?)\b")
    return (
        mistake("publish_not_reached", line=publishes[0])
        if publishes and fires
        else mistake("never_published")
    )


def defined_twice(run: Run) -> Mistake | None:
    """Recognise a method that a later one of the same name replaces."""
    twice = ScriptText(run.source).defined_twice
    return None if twice is None else mistake("defined_twice", name=twice[0], first=twice[1], second=twice[2])


def not_called(run: Run) -> Mistake | None:
    """Recognise a function that was named where it should have been called, or not awaited."""
    if (coroutine := _UNAWAITED.search(run.outcome.stderr.text)) is not None:
        return _unawaited(coroutine[1], ScriptText(run.source))
    script = ScriptText(run.source)
    if (named := script.named_only) is None:
        return None
    made = script.definition(named.name.rpartition(".")[2])
    if named.name.endswith(".publish"):
        given = script.twist_name_at(named.line) or "msg"
    else:
        given = "..." if made is not None and script.asks_for_more(made.line) else ""
    return mistake("not_called", line=named.line, name=named.name, call=f"{named.name}({given})")


def _unawaited(name: str, script: ScriptText) -> Mistake:
    """Return how to run a coroutine: by await in another one, with asyncio where that is used, else plainly."""
    calls = script.lines_with(rf"^[ \t]*(\w+\.)*{name}\(.*\)$")
    if len(calls) != 1 or not script.lines_with(r"\basyncio\.sleep\("):
        return mistake("never_awaited", name=name)
    call = script.lines[calls[0] - 1].strip()
    inside = any(re.match(r"[ \t]*async def\b", head) for _, head in script.outwards(calls[0]))
    right = f"await {call}" if inside else f"asyncio.run({call})"
    return mistake("await_with_asyncio", name=name, line=calls[0], right=right)


def _not_reached(run: Run, kind: str) -> Mistake | None:
    """Recognise a publisher (of `kind`, unless empty) on a line that the script never reached."""
    script = ScriptText(run.source)
    lines = script.lines_with(rf"(?<!def )\bcreate_publisher\(\s*{kind}")
    if not lines:
        return None
    if (named := not_called(run)) is not None:
        return named
    made = script.definition(script.function_around(lines[0]))
    before = range(made.line if made is not None else 0, lines[0])
    ends = [*_exits(script, run.outcome), *script.lines_with(r"^[ \t]*raise SystemExit\b")]
    if run.outcome.status is RunStatus.FINISHED and (early := sorted(set(ends) & set(before))):
        return mistake("exited_early", line=early[0])
    return _in_loop(run, script) or mistake("publisher_not_reached", line=lines[0])


def _waits(run: Run) -> Mistake | None:
    """Return what a script that never published waited for, or what kept its callbacks from running."""
    script = ScriptText(run.source)
    if (topic := noted(run.outcome, "type_mismatch")) is not None:
        return mistake("not_received", topic=topic)
    if (empty := without_added_node(script)) is not None:
        return empty
    if script.lines_with(r"\.publish\(") and (hidden := script.silent_except) is not None:
        return mistake("error_hidden", line=hidden)
    return _in_loop(run, script)


def without_added_node(script: ScriptText) -> Mistake | None:
    """Recognise an executor to which no node was added."""
    made = script.lines_with(r"(?<!Pool)Executor\(")
    added = script.lines_with(r"\badd_node\(|\bspin\w*\(.*\bexecutor ?=")
    return mistake("executor_without_node") if made and not added else None


def _in_loop(run: Run, script: ScriptText) -> Mistake | None:
    """Recognise a loop that was still waiting when the run ended, and whether callbacks could have ended it."""
    if (begins := _loop_at_end(run, script)) is None or (closer := loop_in_callback(run)) is not None:
        return None if begins is None else closer
    in_thread = script.lines_with(r"\btarget ?= ?[\w.]*spin|\bExecutor\(")
    deaf = run.outcome.hears and not script.spins(begins) and not in_thread
    return mistake("waits_without_spin" if deaf else "waits_in_loop", line=begins)


def _runs_in_callback(script: ScriptText, function: str) -> bool:
    """Whether a function is the callback of a timer or subscription, or runs from one."""
    begins = [callback.begins for callback in script.callbacks("timer", "subscription")]
    made = script.definition(function)
    return made is not None and made.line in script.reached_from(begins)


def loop_in_callback(run: Run) -> Mistake | None:
    """Recognise a loop in a callback that waits for what only another callback can bring."""
    script = ScriptText(run.source)
    if (begins := _loop_at_end(run, script)) is None:
        return None
    called_back = run.outcome.hears and _runs_in_callback(script, script.function_around(begins))
    in_parallel = script.lines_with(r"\bMultiThreadedExecutor\(|\bThread\(")
    return mistake("loop_in_callback", line=begins) if called_back and not in_parallel else None


def _only_zeros(run: Run) -> Mistake:
    """Return why nothing but stops arrived."""
    script = ScriptText(run.source)
    if (topic := noted(run.outcome, "type_mismatch")) is not None:
        return mistake("not_received", topic=topic)
    if (stuck := _in_loop(run, script)) is not None and stuck.code == "waits_without_spin":
        return stuck
    compared = script.lines_with(r"^[ \t]*[\w.]+\.(linear|angular)\.[xyz] ?==")
    if compared:
        right = script.lines[compared[0] - 1].strip().replace("==", "=", 1)
        return mistake("compares_for_assigns", line=compared[0], right=right)
    if annotated := script.lines_with(r"^[ \t]*[\w.]+\.(linear|angular)\.[xyz] ?:"):
        return mistake("colon_for_equals", line=annotated[0])
    if noted(run.outcome, "stopped_at_once") is not None:
        return mistake("stopped_at_once")
    if (empty := _empty_message(script)) is not None:
        return empty
    cancels = script.lines_with(r"\btimer\w*\.cancel\(")
    if run.outcome.command_count <= _ONE_CALL and cancels and not script.conditions_around(cancels[0]):
        return mistake("timer_cancelled", line=cancels[0])
    if not script.lines_with(rf"\.(linear\.x|angular\.z) ?{NOT_ZERO}"):
        return mistake("zero_commands")
    heard = run.outcome.heard
    if any(name.endswith("/pose") for name in heard) and script.lines_with(r"\.(x|y|theta)\b"):
        track = run.trajectory
        x, y = (number(float(values[0]), "m") for values in (track.x_m, track.y_m))
        heading = math.remainder(float(track.heading_rad[0]), math.tau)
        return mistake("only_stops_by_pose", x=x, y=y, theta=number(heading, "rad"))
    return mistake("only_stops_heard", topic=heard[0]) if heard else mistake("only_stops")


def _empty_message(script: ScriptText) -> Mistake | None:
    """Recognise a script that fills a message and publishes another one, or fills it too late."""
    filled = script.lines_with(rf"\.(linear\.x|angular\.z) ?{NOT_ZERO}")
    publishes = script.lines_with(r"\.publish\(")
    fresh = script.lines_with(r"\.publish\( ?Twist\( ?\) ?\)")
    if not filled or not publishes:
        return None
    if fresh == publishes:
        message = re.sub(r"^.*?([^\s:;=]*)\.(linear|angular)\..*", r"\1", script.lines[filled[0] - 1])
        return mistake("publishes_empty", line=fresh[0], filled=filled[0], message=message)
    if (other := _other_message(script, filled[0], publishes)) is not None:
        return other
    later = all(number > publishes[-1] for number in filled)
    here = {script.owner_of(number) for number in (*filled, *publishes)}
    return (
        mistake("filled_too_late", line=publishes[-1], filled=filled[0]) if later and len(here) == 1 else None
    )


def _other_message(script: ScriptText, filled: int, publishes: list[int]) -> Mistake | None:
    """Recognise a message that is filled and never published, and another that is published and never filled."""
    known = {found[1] for _, found in script.matches(r"([\w.]+)\.(?:linear|angular)(?:\.[xz])? ?=(?!=)")}
    names = {found[1] for _, found in script.matches(r"\.publish\( ?([\w.]+) ?\)")}
    if len(names) != 1 or len(publishes) != 1 or names & known:
        return None
    name = names.pop()
    made = script.lines_with(rf"(?<![\w.]){re.escape(name)} ?=(?!=)")
    if not made or not all(re.search(r"= ?Twist\( ?\)$", script.lines[at - 1]) for at in made):
        return None
    if script.lines_with(rf"(?<!publish)\((?:[^()]*,)? ?{re.escape(name)} ?[,)]"):
        return None  # a function may fill it
    other = script.lines[filled - 1].strip().partition(".linear")[0].partition(".angular")[0]
    return mistake("other_message", line=publishes[0], published=name, filled=other, given=filled)


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


def steers(run: Run) -> bool:
    """Whether the script computes or compares with the heading that it hears."""
    return run.outcome.hears and bool(ScriptText(run.source).lines_with(_BY_HEADING))


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
