"""What the traced run shows of a script's fault, with the line: told where no change of the script was proven.

Each explainer states what was measured. It proposes nothing, and is silent where the tree and the ledger leave
more than one reason. `stated_cause` returns the first that speaks.
"""

import ast
import itertools
import re
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import RunStatus
from grader.edits.directions import alternating
from grader.edits.fitting import too_large
from grader.edits.poses import begins_again, one_coordinate, set_anew, unfolded, unheard
from grader.edits.received import Motion
from grader.edits.situation import HOLD_NS, OFF_SHARE, Cause, Driven, Situation
from grader.edits.slices import (
    Functions,
    assignments,
    callee,
    calls_of,
    classes_of,
    dotted,
    function_around,
    functions_of,
    is_read,
    named_in,
    number_of,
    statement_around,
)
from grader.edits.spins import SPINS
from grader.edits.tree import ParsedScript

_MAKERS: Final = ("create_timer", "create_subscription", "create_service", "create_client", "Thread", "Timer")
_WORK: Final = ("publish", "create_publisher", "create_timer", "create_subscription", "info", "spin")
_MOST_TEXT: Final = 60
_CLOCKS: Final = ("time", "now", "nanoseconds")
_CLOCK_S: Final = 1e6  # more is a time since 1970, which says nothing to a reader
_CHANGES: Final = 6  # from one of two lines to the other, before they are said to contend
_LOGS: Final = frozenset({"info", "get_logger", "self.get_logger", "print"})
_BRIEF_S: Final = 0.5
_AXIS_NAMES: Final = {"w": "angular.z", "v": "linear.x"}
_LENGTHS: Final = frozenset({"side_error_pct", "length_error_pct", "off_pct"})
_OF_NODE: Final = frozenset(
    """add_on_set_parameters_callback add_waitable clients context create_client create_publisher create_service
    create_subscription create_timer declare_parameter declare_parameters default_callback_group executor get_clock
    get_logger get_name get_parameter guards handle has_parameter publishers services subscriptions timers
    waitables""".split()  # noqa: SIM905 - ten lines shorter
)
"""What rclpy itself asks a node for, or a script calls."""
_UNCALLED: Final = re.compile("'(function|method)' object")
_KEPT: Final = 120  # motions: a ledger holds no more
_MOST_CALLERS: Final = 8  # functions may call each other in a circle
_FEW: Final = 3  # where more is lost, the missing stop is not why
_OUTLINES: Final = frozenset({"off_pct", "covered_pct", "radius_error_pct"})
_LEAST_ARC_DEG: Final = 5.0  # less is a correction of the heading while it drives


def stated_cause(seen: Situation) -> Cause | None:
    """Return the first fact that explains why the script lacks marks; None where none does for certain."""
    if seen.outcome.status in (RunStatus.CRASHED, RunStatus.SYNTAX_ERROR):
        return next(_overridden(seen), None)  # all else the exception says
    of_drives = (
        _open_loop,
        _too_large,
        _alternates,
        _held,
        _in_line,
        _wrong_arc,
        _no_arc,
        _wrong_size,
        _too_slow,
        _unasked,
        _both_at_once,
        _overwritten,
        _no_stop,
    )
    of_flow = (
        _timers_in_callbacks,
        _contended,
        _slow_timer,
        _frozen,
        unheard,
        _unfinished,
        _never_ran,
        _endless,
        set_anew,
        one_coordinate,
        unfolded,
        begins_again,
    )
    explainers = (*of_flow, *(of_drives if seen.outcome.command_count else ()))
    return next((cause for one in explainers for cause in one(seen)), None)


def _overridden(seen: Situation) -> Iterator[Cause]:
    """Yield what the script's class defines under a name of Node's own, which rclpy then fails at."""
    error = seen.outcome.error
    if error is None or error.line is None:
        return
    shown = seen.script.line(error.line)
    nodes = (
        one for one in classes_of(seen.script) if any(dotted(base).endswith("Node") for base in one.bases)
    )
    for one in itertools.chain.from_iterable(node.body for node in nodes):
        if isinstance(one, Functions) and one.name in _OF_NODE:
            in_rclpy = _UNCALLED.search(error.message) is not None and f".{one.name}" not in shown
            if in_rclpy or f".{one.name}()" in error.message:
                yield Cause("overridden", one.lineno, {"name": one.name, "before": error.line})


def _unfinished(seen: Situation) -> Iterator[Cause]:
    """Yield the `pass` that is all of a function that ran, or a TODO behind which nothing was written."""
    misses = not (any(one.motion.v for one in seen.driven) and any(one.motion.w for one in seen.driven))
    handed = _handed_over(seen.script)
    for node in ast.walk(seen.script.tree) if misses else ():
        if isinstance(node, Functions) and isinstance(node.body[-1], ast.Pass):
            empty = all(isinstance(one, ast.Pass) or _is_text(one) for one in node.body)
            if empty and node.name not in handed and node.body[-1].lineno in seen.ledger.ran:
                text = f"{node.name}(): {seen.script.line(node.body[-1].lineno).strip()}"
                yield Cause("unfinished", node.body[-1].lineno, {"text": text[:_MOST_TEXT]})
    lines = seen.script.text.splitlines()
    for number, line in enumerate(lines, start=1):
        before, _, comment = line.partition("#")
        if before.strip() or not comment.strip().startswith("TODO"):
            continue
        after = next((one for one in lines[number:] if one.partition("#")[0].strip()), "")
        is_last = len(after) - len(after.lstrip()) < len(before)
        if is_last or not seen.driven:
            yield Cause("unfinished", number, {"text": comment.strip()[:_MOST_TEXT]})


def _never_ran(seen: Situation) -> Iterator[Cause]:
    """Yield why the first statement that works for the task never ran."""
    if not seen.ledger.whole:
        return
    reached = _Reached(seen)
    for call in sorted(calls_of(seen.script, *_WORK), key=lambda call: call.lineno):
        statement = statement_around(seen.script, call)
        if statement is None or reached.ran(statement):
            continue
        if seen.driven and not dotted(call.func).endswith(("publish", "create_timer")):
            continue
        if (cause := reached.why_not(statement)) is not None:
            yield cause
    for field_name, has_moved in (
        (".linear.x", any(one.motion.v for one in seen.driven)),
        (".angular.z", any(one.motion.w for one in seen.driven)),
    ):
        for one in assignments(seen.script) if not has_moved else ():
            is_set = one.target.endswith(field_name) and number_of(one.value) != 0.0
            if is_set and not reached.ran(one.statement) and (cause := reached.why_not(one.statement)):
                yield cause


class _Reached:
    """Which statements ran, and what kept others from running."""

    def __init__(self, seen: Situation) -> None:
        self._seen = seen
        self._script = seen.script
        self._end = {line for line, _, _ in seen.ledger.end}

    def ran(self, statement: ast.stmt) -> bool:
        """Whether a statement began; of a compound one its head."""
        body = getattr(statement, "body", None)
        last = body[0].lineno if isinstance(body, list) and body else (statement.end_lineno or 0) + 1
        return any(
            line in self._seen.ledger.ran for line in range(statement.lineno, max(last, statement.lineno + 1))
        )

    def why_not(self, statement: ast.stmt, most_callers: int = _MOST_CALLERS) -> Cause | None:
        """Return what kept a statement from running; None where that is not plain."""
        line = statement.lineno
        inner: ast.stmt = statement
        while True:
            block = self._script.block_of(inner)
            place = next(i for i, one in enumerate(block) if one is inner)
            if (before := self._ended_before(block[:place])) is not None:
                return Cause(before[0], line, {"before": before[1]})
            above = self._script.parent(inner)
            if isinstance(above, Functions):
                return None if self.ran(above.body[0]) else self._function(above, line, most_callers - 1)
            if isinstance(above, ast.If | ast.While | ast.For) and self.ran(above):
                return None if self.ran(block[0]) else self._head(above, inner, line)
            if not isinstance(above, ast.stmt) or isinstance(above, ast.Try | ast.ClassDef):
                return None
            inner = above

    def _ended_before(self, earlier: list[ast.stmt]) -> tuple[str, int] | None:
        """Return the statement before that never came to its end, with the code that says how."""
        for one in reversed(earlier):
            if not self.ran(one):
                continue
            lines = range(one.lineno, (one.end_lineno or one.lineno) + 1)
            waiting = next((line for line in lines if line in self._end), None)
            return None if waiting is None else ("waits_before", waiting)
        return None

    def _head(self, above: ast.If | ast.While | ast.For, inner: ast.stmt, line: int) -> Cause | None:
        """Return what an `if` or a loop that ran says of a statement in it that never did."""
        if isinstance(above, ast.For):
            return Cause("empty_loop", line, {"before": above.lineno})
        is_else = any(one is inner for one in above.orelse)
        test = self._script.source(above.test)
        is_exact = not isinstance(above, ast.If) or _is_exact(above.test)
        if self._seen.driven and (self._seen.outcome.hears or not is_else) and not is_exact:
            return None  # it waits for what the drive comes to: that this never came is the drive's fault
        if is_else and self._seen.outcome.hears and not self._seen.driven:
            end = self._flag(above.test) or above
            test = self._script.source(end.test)
            return Cause("true_at_start", line, {"before": end.lineno, "test": test})
        return Cause("always_true" if is_else else "never_true", line, {"before": above.lineno, "test": test})

    def _flag(self, test: ast.expr) -> ast.If | None:
        """Return the `if` that ran and set the flag that a test asks for."""
        for one in assignments(self._script):
            above = self._script.parent(one.statement)
            if one.target == dotted(test) and self.ran(one.statement) and isinstance(above, ast.If):
                return above
        return None

    def _function(self, function: Functions, line: int, most_callers: int) -> Cause | None:
        """Return why a function never ran: nobody calls it, or nothing runs the callback that it is."""
        name = function.name
        if name == "__init__":
            return None
        mentions = [node for node in ast.walk(self._script.tree) if _names(node, name)]
        if (
            not mentions
            and name == "main"
            and any(one.code == "main_called" for one in self._seen.outcome.notes)
        ):
            return None  # as `ros2 run` does
        if not mentions:
            return Cause("never_called", line, {"name": name, "before": function.lineno})
        around = (one for node in mentions for one in self._script.around(node))
        maker = next((one for one in around if callee(one).endswith(_MAKERS)), None)
        if maker is None:
            calls = [
                statement_around(self._script, one)
                for one in mentions
                if not _is_in(self._script, one, function)
            ]
            first = None if any(one is None or self.ran(one) for one in calls) else next(iter(calls), None)
            return None if first is None or not most_callers else self.why_not(first, most_callers)
        statement = statement_around(self._script, maker)
        if statement is None or not self.ran(statement):
            return None if statement is None else self.why_not(statement)
        return None  # a callback that never came: what is known of its topic or timer says more


def _is_exact(test: ast.expr) -> bool:
    """Whether a test asks for one value only, or for a name."""
    return not isinstance(test, ast.Compare) or isinstance(test.ops[0], ast.Eq | ast.NotEq | ast.Is)


def _names(node: ast.AST, name: str) -> bool:
    return (isinstance(node, ast.Name) and node.id == name) or (
        isinstance(node, ast.Attribute) and node.attr == name
    )


def _loops_at_the_end(seen: Situation) -> Iterator[tuple[ast.While, dict[str, float]]]:
    """Yield the loops with a test that the script was still in at the end, with the numbers of their names."""
    if seen.outcome.status is not RunStatus.INTERRUPTED:
        return
    for line, _, values in seen.ledger.end:
        statement = next(iter(seen.script.statements_on(line)), None)
        loop = statement and next(
            (one for one in (statement, *seen.script.around(statement)) if isinstance(one, ast.While)), None
        )
        if (
            isinstance(loop, ast.While)
            and not isinstance(loop.test, ast.Constant)
            and not callee(loop.test).endswith("ok")
        ):
            yield loop, values


def _frozen(seen: Situation) -> Iterator[Cause]:
    """Yield the loop that waits for what nothing changes while it runs: no callback can, or nothing sets it."""
    for loop, _ in _loops_at_the_end(seen):
        called = {dotted(one.func) for one in ast.walk(loop.test) if isinstance(one, ast.Call)}
        parts = {dotted(node) for node in ast.walk(loop.test)} - {"", *called}
        names = {one for one in parts if not any(other.startswith(f"{one}.") for other in parts)}
        test = seen.script.source(loop.test)
        threads = calls_of(seen.script, "Thread", "MultiThreadedExecutor")
        if threads or not names or any(one in test for one in _CLOCKS):
            continue
        values: dict[str, object] = {"test": test, "name": ", ".join(sorted(names))}
        if not called and not _is_set_elsewhere(seen.script, names, loop):
            yield Cause("frozen_loop", loop.lineno, values)
        elif (heard := _set_by_callbacks(seen.script, names)) and not _spins_in(seen.script, loop):
            within = {name for _, name, _ in seen.ledger.end} & _handed_over(seen.script)
            values = {"test": test, "name": heard, "function": next(iter(sorted(within)), "")}
            yield Cause("deaf_callback" if within else "deaf_loop", loop.lineno, values)


def _is_set_elsewhere(script: ParsedScript, names: set[str], loop: ast.While) -> bool:
    """Whether a name may change while a loop runs: set in the loop, or in a function that does not make it."""
    function = function_around(script, loop)
    for one in assignments(script):
        if not any(_may_be(one.target, name) for name in names):
            continue
        around = function_around(script, one.statement)
        if _is_in(script, one.statement, loop):
            return True
        if around is not function and getattr(around, "name", "__init__") != "__init__":
            return True
    return False


def _may_be(target: str, name: str) -> bool:
    """Whether a name may stand for what an assignment sets, or a part of it: ``node.pose.x`` for ``self.pose``."""
    _, dot, last = target.rpartition(".")
    return last in name.split(".")[1:] if dot else target == name.partition(".")[0]


def _spins_in(script: ParsedScript, loop: ast.AST, most_calls: int = 3) -> bool:
    """Whether a loop, or a function that it calls, lets callbacks run."""
    called = {dotted(one.func).rpartition(".")[2] for one in ast.walk(loop) if isinstance(one, ast.Call)}
    if called & {*SPINS, "add_node", "spin_some"}:
        return True
    functions = [one for one in functions_of(script) if one.name in called]
    return most_calls > 0 and any(_spins_in(script, one, most_calls - 1) for one in functions)


def _endless(seen: Situation) -> Iterator[Cause]:
    """Yield the loop that the script was still in at the end, its test and what the names in it stood for."""
    for loop, values in _loops_at_the_end(seen):
        test = seen.script.source(loop.test)
        names = {dotted(node) for node in ast.walk(loop.test)} - {""}
        shown = ", ".join(f"{name} = {values[name]:g}" for name in sorted(names) if name in values)
        if shown and not any(one in test for one in _CLOCKS) and max(map(abs, values.values())) < _CLOCK_S:
            yield Cause("endless_loop", loop.lineno, {"test": test, "values": shown})


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(getattr(statement.value, "value", None), str)


def _is_in(script: ParsedScript, node: ast.AST, loop: ast.AST) -> bool:
    return any(one is loop for one in script.around(node))


def _set_by_callbacks(script: ParsedScript, names: set[str]) -> str:
    """Return the first of `names` that only a subscription's callback sets; empty if none is."""
    callbacks = named_in(calls_of(script, "create_subscription"))
    for one in assignments(script):
        if any(_may_be(one.target, name) for name in names):
            functions = [node.name for node in script.around(one.statement) if isinstance(node, Functions)]
            if callbacks & set(functions):
                return one.target
    return ""


def _timers_in_callbacks(seen: Situation) -> Iterator[Cause]:
    """Yield a timer that a timer's callback creates each time it runs, and that nothing cancels."""
    makers = calls_of(seen.script, "create_timer")
    callbacks = named_in(makers)
    if calls_of(seen.script, "cancel", "destroy_timer"):
        return
    for call in makers:
        inside = [one.name for one in seen.script.around(call) if isinstance(one, Functions)]
        if inside and inside[0] in callbacks and call.lineno in seen.ledger.ran:
            yield Cause("timer_in_callback", call.lineno, {"name": inside[0]})


def _contended(seen: Situation) -> Iterator[Cause]:
    """Yield two lines that command by turns, each something else, from two callbacks or one and the main part.

    The commands of one of them are overruled before they do anything.
    """
    handed = _handed_over(seen.script)
    lasted_s = {id(one.motion): one.seconds for one in seen.driven}
    for one, other in itertools.pairwise(seen.ledger.motions):
        pair = {one.line, other.line}
        alike = (one.v, one.w) == (other.v, other.w) or _source_of(one, handed) == _source_of(other, handed)
        if len(pair) < 2 or alike:
            continue
        changes = sum({a.line, b.line} == pair for a, b in itertools.pairwise(seen.ledger.motions))
        rows = [[each for each in seen.ledger.motions if each.line == line] for line in pair]
        if changes >= _CHANGES and any(
            all(lasted_s.get(id(each), 0.0) < _BRIEF_S for each in row) for row in rows
        ):
            yield Cause("contended", min(pair), {"other": max(pair)})
            return


def _handed_over(script: ParsedScript) -> set[str]:
    """Return the names of the functions that are given to timers, subscriptions and threads."""
    return named_in(calls_of(script, *_MAKERS))


def _source_of(motion: Motion, handed: set[str]) -> str:
    """Return the callback that a motion came from; empty for the main program."""
    return next((function for _, function, _ in reversed(motion.stack) if function in handed), "")


def _slow_timer(seen: Situation) -> Iterator[Cause]:
    """Yield the timer whose callback commands a motion, and comes again only after turtlesim has dropped it."""
    handed = _handed_over(seen.script)
    for motion, longest_ns in _dropped(seen):
        if (call := _timer_of(seen.script, _source_of(motion, handed))) is not None:
            values: dict[str, object] = {"name": dotted(call.args[1]), "period": f"{longest_ns / 1e9:.3g}"}
            waits = [line for line, (times, ns) in motion.waits.items() if times and ns > HOLD_NS * times / 2]
            sleeps = [one.lineno for one in calls_of(seen.script, "sleep") if one.lineno in waits]
            yield Cause("sleeps", sleeps[0], values) if sleeps else Cause("period", call.lineno, values)


def _alternates(seen: Situation) -> Iterator[Cause]:
    """Yield the line whose motion goes one way and then the other, by turns, where all are to go one way."""
    for axis, motions in alternating(seen):
        first, second = (one.motion.w if axis == "w" else one.motion.v for one in motions[:2])
        values: dict[str, object] = {
            "axis": _AXIS_NAMES[axis],
            "first": f"{first:g}",
            "second": f"{second:g}",
        }
        lines = zip(motions[0].motion.stack, motions[1].motion.stack, strict=False)
        line = next((b[0] for a, b in lines if a[0] != b[0]), motions[0].motion.line)
        yield Cause("alternates", line, values)


def _too_large(seen: Situation) -> Iterator[Cause]:
    """Yield the drive with which a figure of right turns leaves the field."""
    if (large := too_large(seen)) is not None:
        values: dict[str, object] = {"side": f"{abs(large.drive.length_m):.2g}", "most": large.most}
        yield Cause("too_large", large.drive.motion.line, values)


def _open_loop(seen: Situation) -> Iterator[Cause]:
    """Yield the first motion of a car that slips, where what the callbacks keep is only waited for."""
    script, callbacks = seen.script, named_in(calls_of(seen.script, "create_subscription"))
    nodes = list(ast.walk(script.tree))
    functions = [one for one in nodes if isinstance(one, Functions) and one.name in callbacks]
    inside = {id(node) for function in functions for node in ast.walk(function)}
    kept = {one.target for one in assignments(script) if id(one.statement) in inside}
    calls = [
        dotted(one.func) or getattr(one.func, "attr", "")
        for one in nodes
        if id(one) in inside and isinstance(one, ast.Call)
    ]
    elsewhere = not kept and not set(calls) <= _LOGS  # it may keep it in a list
    if not seen.asked.slips or not seen.driven or elsewhere:
        return
    publishes = any(id(call) in inside for call in calls_of(script, "publish"))
    outside = [one for one in nodes if id(one) not in inside and dotted(one) in kept and is_read(script, one)]
    if not publishes and all(_is_idle(script, one) for one in outside):
        yield Cause("open_loop", seen.driven[0].motion.line)


def _is_idle(script: ParsedScript, name: ast.AST) -> bool:
    """Whether a name is only asked whether it has come, or logged."""
    parent = script.parent(name)
    asks = isinstance(parent, ast.Compare) and isinstance(parent.ops[0], ast.Is | ast.IsNot)
    calls = [one.func for one in script.around(name) if isinstance(one, ast.Call)]
    return asks or isinstance(parent, ast.UnaryOp) or any(getattr(one, "attr", "") == "info" for one in calls)


def _too_slow(seen: Situation) -> Iterator[Cause]:
    """Yield the drive that goes on at the horizon, where all up to it is right: it needs more time."""
    drives = [one for one in seen.driven if one.is_drive]
    count = max((one for one in seen.wanted.counts if one > len(drives)), default=0)
    if seen.outcome.status is not RunStatus.INTERRUPTED or seen.comes_to_rest or not 1 < len(drives) < count:
        return
    whole = drives[:-1] if seen.driven[-1] is drives[-1] else drives
    lengths = [abs(one.length_m) for one in whole]
    if max(lengths) - min(lengths) > OFF_SHARE * max(lengths):
        return
    needed_s = whole[-1].motion.t / 1e9 * count / (len(whole) - 1) if len(whole) > 1 else 0.0
    limit_s = seen.outcome.duration_ns / 1e9
    if needed_s > limit_s:
        values: dict[str, object] = {"rate": f"{whole[0].motion.v:g}", "side": f"{whole[0].seconds:.3g}"}
        values |= {"needed": f"{needed_s:.3g}", "limit": f"{limit_s:.3g}", "count": count}
        yield Cause("too_slow", whole[0].motion.line, values)


def _held(seen: Situation) -> Iterator[Cause]:
    """Yield the line whose command came once, and that turtlesim dropped before the wait after it was over."""
    for motion in (one for one, _ in _dropped(seen) if one.times == 1):
        yield Cause("held", motion.line, {"v": f"{motion.v:g}", "w": f"{motion.w:g}"})


def _dropped(seen: Situation) -> Iterator[tuple[Motion, int]]:
    """Yield the motions whose command turtlesim dropped each time, and the longest wait after one in ns."""
    for driven in seen.distinct:
        longest_ns = max((ns // times for times, ns in driven.motion.waits.values() if times), default=0)
        if longest_ns > HOLD_NS and (driven.is_held or driven.motion.times > 1):
            yield driven.motion, longest_ns


def _in_line(seen: Situation) -> Iterator[Cause]:
    """Yield the drive that goes on in the line of the one before: as many as wanted came, but a turn less."""
    drives = [one for one in seen.driven if one.is_drive]
    if "sides" not in seen.lost or len(drives) not in seen.wanted.counts:
        return
    for before, after in itertools.pairwise(seen.driven):
        if before.is_drive and after.is_drive:
            lines = zip(before.motion.stack, after.motion.stack, strict=False)
            first, second = next(((a[0], b[0]) for a, b in lines if a[0] != b[0]), (0, 0))
            if first:
                yield Cause("in_line", second, {"before": first})


def _timer_of(script: ParsedScript, callback: str) -> ast.Call | None:
    """Return the call that has a timer run `callback`; None if there is none, or the script ends timers itself."""
    if not callback or calls_of(script, "cancel", "destroy_timer"):
        return None
    timers = (call for call in calls_of(script, "create_timer") if len(call.args) > 1)
    return next((one for one in timers if dotted(one.args[1]).rpartition(".")[2] == callback), None)


def _wrong_arc(seen: Situation) -> Iterator[Cause]:
    """Yield the arcs that have another radius than the wanted one in their place, or another angle."""
    arcs = [one for one in seen.driven if one.is_arc]
    wanted = seen.wanted.arcs
    if len(arcs) != len(wanted) or not seen.lost & _OUTLINES:
        return
    for driven, (radius_m, to_left_deg) in zip(arcs, wanted, strict=True):
        motion = driven.motion
        size_m, size_deg = abs(motion.v / motion.w), abs(driven.angle_deg)
        angle_deg = abs(to_left_deg)
        values = {"rate": f"{motion.w:g}", "seconds": driven.seconds}
        if radius_m and abs(size_m - radius_m) > OFF_SHARE * radius_m:
            size = {"size": size_m, "wanted": radius_m, "unit": "m", "speed": f"{motion.v:g}"}
            yield Cause("radius", motion.line, {**values, **size})
        elif abs(size_deg - angle_deg) > OFF_SHARE * angle_deg:
            size = {"size": size_deg, "wanted": angle_deg, "unit": "deg"}
            yield Cause("turned_plain", motion.line, {**values, **size})


def _no_arc(seen: Situation) -> Iterator[Cause]:
    """Yield the motion that is no arc, or one to the other side, where the wanted path has an arc."""
    wanted = seen.wanted.arcs
    if len(seen.driven) != len(wanted) or not seen.lost & _OUTLINES:
        return
    first = seen.driven[0].motion
    for number, (driven, (_, angle_deg)) in enumerate(zip(seen.driven, wanted, strict=True), start=1):
        v, w = driven.motion.v, driven.motion.w
        values: dict[str, object] = {"number": number, "v": f"{v:g}", "w": f"{w:g}"}
        if not driven.is_arc:
            yield Cause("no_arc_spins" if driven.is_turn else "no_arc_straight", driven.motion.line, values)
        elif v * w * first.v * first.w * angle_deg * wanted[0][1] < 0.0:
            yield Cause("other_side", driven.motion.line, values)


def _overwritten(seen: Situation) -> Iterator[Cause]:
    """Yield the stop that ran in an `if` that goes on to publish a motion."""
    moving = {one.motion.line for one in seen.driven} if "settled" in seen.lost else set()
    for call in calls_of(seen.script, "publish") if moving else ():
        around = [one for one in seen.script.around(call) if isinstance(one, ast.stmt)][:2]
        above = around[-1] if around else None
        if call.lineno not in seen.ledger.ran or not isinstance(above, ast.If) or around[0] not in above.body:
            continue
        leaves = isinstance(above.body[-1], ast.Return | ast.Break | ast.Raise | ast.Continue)
        block = seen.script.block_of(above)
        behind = block[1 + next(i for i, one in enumerate(block) if one is above) :]
        after = next((one for one in behind if isinstance(one, ast.Expr) and one.lineno in moving), None)
        if not leaves and after is not None and _is_stop(seen.script, call, above):
            yield Cause("overwritten", call.lineno, {"before": after.lineno})


def _is_stop(script: ParsedScript, call: ast.Call, above: ast.If) -> bool:
    """Whether a publish in an `if` is of a new message, or of one that is set to zeros there."""
    message = call.args[0] if call.args else None
    if isinstance(message, ast.Call):
        return not message.args and not message.keywords
    fields = [
        one.value
        for one in assignments(script)
        if one.statement in above.body and dotted(message) and one.target.startswith(f"{dotted(message)}.")
    ]
    return bool(fields) and all(number_of(one) == 0.0 for one in fields)


def _wrong_size(seen: Situation) -> Iterator[Cause]:
    """Yield the motion that was longest off the wanted size, what it came to, and which waits made it so."""
    no_drives = seen.wanted.counts and not any(one.is_drive for one in seen.driven)
    for driven in seen.distinct:
        size, wanted, unit = _compared(seen, driven)
        if (
            wanted is None
            or (no_drives and driven.is_turn)  # then the turns at the corners are one
            or seen.is_part(driven)
            or abs(size - wanted) <= OFF_SHARE * wanted
            or (unit == "m" and not seen.lost & _LENGTHS)
        ):
            continue
        line = driven.motion.line
        waits = ", ".join(
            f"{row} ({times} × {ns / times / 1e9:.4g} s)"
            for row, (times, ns) in driven.motion.waits.items()
            if times
        )
        rate = driven.motion.w if unit == "deg" else driven.motion.v
        values = {"size": size, "wanted": wanted, "unit": unit, "rate": f"{rate:g}"}
        code, plain = ("turned", "turned_plain") if unit == "deg" else ("drove", "drove_plain")
        yield Cause(code if waits else plain, line, {**values, "seconds": driven.seconds, "waits": waits})


def _compared(seen: Situation, driven: Driven) -> tuple[float, float | None, str]:
    """Return the size of a motion and the nearest wanted one, if the marks that were lost are about it."""
    if driven.is_turn:
        size, wanted, unit = abs(driven.angle_deg), seen.wanted.turns_deg, "deg"
    elif driven.is_drive:
        size, wanted, unit = abs(driven.length_m), seen.wanted.lengths_m, "m"
        sizes = sorted({round(abs(one.length_m), 2) for one in seen.distinct if one.is_drive})
        if len(sizes) == len(wanted):  # the longer of two sides is meant to be the longer one
            return size, sorted(wanted)[sizes.index(round(size, 2))], unit
    else:
        return 0.0, None, ""
    return size, min(wanted, key=lambda one: abs(one - size), default=None), unit


def _unasked(seen: Situation) -> Iterator[Cause]:
    """Yield a line that turns where none is wanted, or drives where the car is to stay in its place."""
    turns = "turned_deg" in seen.lost and not seen.wanted.turns_deg
    for driven in seen.distinct:
        if (turns and driven.motion.w) or ("drift_m" in seen.lost and driven.motion.v):
            values: dict[str, object] = {"v": f"{driven.motion.v:g}", "w": f"{driven.motion.w:g}"}
            yield Cause("unasked", driven.motion.line, values)


def _both_at_once(seen: Situation) -> Iterator[Cause]:
    """Yield a line that drives and turns at a time where single turns and drives are wanted."""
    if not seen.wanted.turns_deg or not seen.lost & {"sides", "curved_pct", "corner_deg"}:
        return
    for driven in seen.distinct:
        if driven.is_arc and abs(driven.angle_deg) >= _LEAST_ARC_DEG:
            yield Cause("arc", driven.motion.line, {"v": f"{driven.motion.v:g}", "w": f"{driven.motion.w:g}"})


def _no_stop(seen: Situation) -> Iterator[Cause]:
    """Yield the line that commanded the last motion, where no stop came after it."""
    last = next(iter(seen.ledger.motions[-1:]), None)
    if last is None or last.is_stop or not seen.comes_to_rest:
        return
    if len(seen.ledger.motions) >= _KEPT:
        return  # of the many motions of a controller only the first are kept
    moves_on = "settled" in seen.lost and len(seen.lost) <= _FEW
    if moves_on or seen.driven[-1].is_held:  # for a second more than was meant
        yield Cause("no_stop", last.line, {"v": f"{last.v:g}", "w": f"{last.w:g}"})
