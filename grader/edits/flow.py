"""Changes of what is published, when, and whether a line runs at all."""

import ast
from collections.abc import Iterator
from typing import Final

from grader.edits.situation import Proposal, Situation, removing, replacing
from grader.edits.slices import (
    Functions,
    NameSet,
    assignments,
    callee,
    calls_of,
    dotted,
    function_around,
    imported,
    is_call,
    is_method,
    named_in,
    number_of,
)
from grader.edits.spins import ENDS, node_name
from grader.edits.tree import Edit, ParsedScript

_AXES: Final = {
    "linear.y": "linear.x",
    "linear.z": "linear.x",
    "angular.x": "angular.z",
    "angular.y": "angular.z",
    "linear.w": "linear.x",
}
_SHORTENS: Final = (".remove", ".pop", ".append")
_BURST: Final = 3
_LAST: Final = 3
_LONG_PAUSE_S: Final = 0.5
_SHORT_PAUSE: Final = "0.02"
"""Turtlesim takes a command each 16 ms; of a second's turn this is a degree."""
_Loops: Final = (ast.For, ast.While)


def flow_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of publishes, loops, stops and calls."""
    known = assignments(seen.script)
    yield from _axes(seen, known)
    yield from _for_assignment(seen)
    yield from _empty_messages(seen, known)
    yield from _left_over(seen, known)
    yield from _stops(seen)
    yield from _moved(seen)
    yield from _out_of_branches(seen)
    yield from _into_ends(seen)
    yield from _counters(seen, known)
    yield from _unpublished(seen, known)
    yield from _pauses(seen)
    yield from _sent_once(seen)
    yield from _removed(seen)
    yield from _guards(seen)
    yield from _logs(seen)
    yield from _late(seen, known)
    yield from _negated(seen)
    yield from _sleeps_in_callbacks(seen)


def _guards(seen: Situation) -> Iterator[Proposal]:
    """Yield the name that a script has when it is run, for another one that it is compared with."""
    for node in seen.script.tree.body:
        if (
            isinstance(node, ast.If)
            and isinstance(node.test, ast.Compare)
            and dotted(node.test.left) == "__name__"
        ):
            given = node.test.comparators[0]
            if getattr(given, "value", None) != "__main__":
                yield replacing(seen.script, "name", 0.2, given, "'__main__'")


def _logs(seen: Situation) -> Iterator[Proposal]:
    """Yield the level that is wanted of a message, and a log for what is only printed."""
    for node in ast.walk(seen.script.tree) if seen.asked.logs else ():
        func = node.func if isinstance(node, ast.Call) else None
        if func is None:
            continue
        if dotted(func) in ("print", "logging.info", "logging.warning"):
            owner = "self" if is_method(seen.script, node) else node_name(seen.script)
            new = f"{owner}.get_logger().info"
        elif isinstance(func, ast.Attribute) and func.attr in ("warn", "warning", "error", "debug", "fatal"):
            new = f"{seen.script.source(func.value)}.info"
        else:
            continue
        yield replacing(seen.script, "name", 0.5, func, new)


def _late(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a publish behind the fields of its message that are set after it in the same block."""
    for call in calls_of(seen.script, "publish"):
        statement = seen.script.parent(call)
        message = dotted(call.args[0]) if call.args else ""
        if not message or not isinstance(statement, ast.Expr):
            continue
        block = seen.script.block_of(statement)
        later = [one.statement for one in known if one.target.startswith(f"{message}.")]
        behind = [one for one in later if one in block and one.lineno > statement.lineno]
        if behind:
            text = seen.script.source(statement)
            edits = (seen.script.removed(statement), seen.script.inserted_after(behind[-1], text))
            values = {"line": statement.lineno, "loop": behind[-1].lineno}
            yield Proposal("published_late", 1.2, edits, values)


def _axes(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the axis that a turtle has, for one that it has not."""
    edits, line = [], 0
    for one in known:
        for wrong, right in _AXES.items():
            if one.target.endswith(f".{wrong}") and number_of(one.value) != 0.0:
                target = _target_of(one.statement)
                if target is not None:
                    edits.append(seen.script.replaced(target, one.target.removesuffix(wrong) + right))
                    line = line or one.statement.lineno
                    yield Proposal("axis", 1.0, (edits[-1],), {"line": line, "old": wrong, "new": right})
    if len(edits) > 1:
        yield Proposal("axis", 1.1, tuple(edits), {"line": line, "old": "angular.x", "new": "angular.z"})


def _target_of(statement: ast.stmt) -> ast.expr | None:
    if isinstance(statement, ast.Assign):
        return statement.targets[0] if len(statement.targets) == 1 else None
    return statement.target if isinstance(statement, ast.AugAssign | ast.AnnAssign) else None


def _for_assignment(seen: Situation) -> Iterator[Proposal]:
    """Yield `=` for a comparison or an annotation that stands alone, and `+=` for `+`."""
    for node in ast.walk(seen.script.tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Compare) and len(node.value.ops) == 1:
            left, right = node.value.left, node.value.comparators[0]
            if isinstance(node.value.ops[0], ast.Eq):
                start, end = seen.script.span(left)[1], seen.script.span(right)[0]
                yield Proposal("assign", 0.5, (Edit(start, end, " = "),), {"line": node.lineno})
        elif (
            isinstance(node, ast.AnnAssign) and node.value is None and number_of(node.annotation) is not None
        ):
            start, end = seen.script.span(node.target)[1], seen.script.span(node.annotation)[0]
            yield Proposal("assign", 0.5, (Edit(start, end, " = "),), {"line": node.lineno})
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.BinOp) and dotted(node.value.left):
            start, end = seen.script.span(node.value.left)[1], seen.script.span(node.value.right)[0]
            sign = seen.script.text[start:end].strip()
            if sign in ("+", "-", "*", "/"):
                name, by = seen.script.source(node.value.left), seen.script.source(node.value.right)
                values = {"line": node.lineno, "new": f"{name} {sign}= {by}"}
                yield Proposal("kept", 0.5, (Edit(start, end, f" {sign}= "),), values)


def _empty_messages(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the message that was filled, where another or a new one is published: if nothing else sends it."""
    messages = [(_message_of(one), function_around(seen.script, one.statement)) for one in known]
    filled = [one for one in messages if one[0]]
    fresh = [one for one in known if callee(one.value) == seen.twist]
    unsent = sorted({name for name, function in filled if not _is_sent(seen.script, name, function)})
    for call in calls_of(seen.script, "publish"):
        if not call.args:
            continue
        given = call.args[0]
        is_new = isinstance(given, ast.Call) and callee(given) == seen.twist and not given.args
        if is_new or (dotted(given) and all(dotted(given) != name for name, _ in filled)):
            is_looped = not seen.driven and any(isinstance(one, _Loops) for one in seen.script.around(call))
            for name in unsent or (sorted({one for one, _ in filled}) if is_looped else ()):
                cost = 0.8 if is_new else 1.5  # a new message is empty: it cannot be what was meant
                yield replacing(seen.script, "message", cost, given, name)
    yield from _filled_nowhere(seen, fresh)


def _message_of(one: NameSet) -> str:
    """Return the name of the message whose field an assignment sets; empty if it sets none."""
    message, dot, _ = one.target.replace(".angular.", ".linear.").partition(".linear.")
    return message if dot else ""


def _is_sent(script: ParsedScript, name: str, function: ast.AST | None) -> bool:
    """Whether a message is given to a call or returned: a local one in its function, another one anywhere."""
    within = script.tree if function is None or "." in name else function
    for node in ast.walk(within):
        given = [node.value] if isinstance(node, ast.Return) else getattr(node, "args", ())
        shown = callee(node).endswith(("print", "info"))
        if (
            isinstance(node, ast.Call | ast.Return)
            and not shown
            and any(dotted(one) == name for one in given)
        ):
            return True
    return False


def _filled_nowhere(seen: Situation, fresh: list[NameSet]) -> Iterator[Proposal]:
    """Yield one message for fields that are set on new ones: ``Twist().linear.x = 1.0``."""
    name = fresh[0].target if fresh else "msg"
    edits: list[Edit] = []
    first: ast.stmt | None = None
    for node in ast.walk(seen.script.tree):
        holder: ast.expr | None = node.targets[0] if isinstance(node, ast.Assign) else None
        while isinstance(holder, ast.Attribute):
            holder = holder.value
        if isinstance(node, ast.Assign) and holder is not None and callee(holder) == seen.twist:
            edits.append(seen.script.replaced(holder, name))
            first = first or node
    if first is None:
        return
    if not fresh:
        edits.append(seen.script.inserted_before(first, f"{name} = {seen.twist}()"))
    for call in calls_of(seen.script, "publish"):
        if call.args and isinstance(call.args[0], ast.Call) and dotted(call.args[0].func) == seen.twist:
            edits.append(seen.script.replaced(call.args[0], name))
    yield Proposal("one_message", 1.0, tuple(edits), {"line": first.lineno, "new": name})


def _left_over(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a motion without the speed or the turn that it should not have: set to zero, or not set at all."""
    for driven in seen.distinct:
        if not driven.is_arc or (published := seen.publish_on(driven.motion.line)) is None:
            continue
        _, message = published
        statement = next(iter(seen.script.statements_on(driven.motion.line)), None)
        if statement is None:
            continue
        for field, other, value in (
            ("linear.x", "angular.z", driven.motion.v),
            ("angular.z", "linear.x", driven.motion.w),
        ):
            for one in known:
                if one.target.endswith(field) and number_of(one.value) == value:
                    values = {"line": one.statement.lineno, "field": field}
                    yield Proposal("left_over", 2.0, (seen.script.replaced(one.value, "0.0"),), values)
                elif one.target.endswith(other) and number_of(one.value) != 0.0:
                    line = f"{one.target.removesuffix(other)}{field} = 0.0"
                    values = {"line": one.statement.lineno, "field": field}
                    edit = seen.script.inserted_after(one.statement, line)
                    yield Proposal("left_over", 2.2, (edit,), values)
            if message:
                values = {"line": driven.motion.line, "field": field}
                line = f"{message}.{field} = 0.0"
                yield Proposal(
                    "left_over",
                    2.4,
                    (seen.script.inserted_before(_outermost(seen, statement), line),),
                    values,
                )


def _outermost(seen: Situation, statement: ast.stmt) -> ast.stmt:
    """Return the loop around a statement, the outermost within its function, or the statement itself."""
    outermost = statement
    for node in seen.script.around(statement):
        if isinstance(node, Functions | ast.ClassDef):
            break
        if isinstance(node, _Loops):
            outermost = node
    return outermost


def _stops(seen: Situation) -> Iterator[Proposal]:
    """Yield a stop behind the last motion: behind its loop, or behind what called for it."""
    if (
        not any(one.is_held for one in seen.driven)
        and seen.ledger.motions[-1:]
        and seen.ledger.motions[-1].is_stop
    ):
        return  # each motion was ended
    last = next((one for one in reversed(seen.ledger.motions) if not one.is_stop), None)
    published = None if last is None else seen.publish_on(last.line)
    if last is None or published is None:
        return
    publisher, _ = published
    stop = f"{publisher}.publish({seen.twist}())"
    for call in calls_of(seen.script, "cancel"):
        end, is_own = seen.script.parent(call), publisher.startswith("self.") == is_method(seen.script, call)
        if isinstance(end, ast.Expr) and is_own and call.lineno in seen.ledger.ran:
            edit = seen.script.inserted_after(end, stop)
            yield Proposal("stop", 2.0, (edit,), {"line": call.lineno})
    for depth, (line, function, _) in enumerate(last.stack):
        statement = next(iter(seen.script.statements_on(line)), None)
        if statement is None:
            continue
        behind = _outermost(seen, statement)
        own = stop if publisher.startswith("self.") == is_method(seen.script, behind) else ""
        if own:
            values = {"line": behind.end_lineno or behind.lineno, "function": function}
            cost = 2.5 + depth * 0.5
            yield Proposal("stop", cost, (seen.script.inserted_after(behind, own),), values)
            wait = "time.sleep(0.1)"
            if depth:
                yield Proposal("stop", cost + 1.0, (seen.script.inserted_after(behind, own, wait),), values)


def _moved(seen: Situation) -> Iterator[Proposal]:
    """Yield a statement moved into the loop before it, or out of the loop that it ends."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, _Loops) or node.lineno not in seen.ledger.ran:
            continue
        later = seen.script.behind(node)[:2]
        for count in range(1, len(later) + 1):
            sends_twice = any(is_call(one, ("publish",)) for one in later[:count]) and _publishes(node)
            if any(isinstance(one, ast.Expr) for one in later[:count]) and not sends_twice:
                edits = _put_behind(seen.script, node.body[-1], later[:count])
                yield Proposal(
                    "into_loop", 3.5 + count * 0.2, edits, {"line": later[0].lineno, "loop": node.lineno}
                )
        for count in (1, 2):
            is_paced = _publishes(node) and any(_is_wait(one) for one in node.body[-count:])
            if len(node.body) > count and not is_paced:
                moved = node.body[-count]
                if count == 1 and (
                    isinstance(moved, ast.Assign | ast.AugAssign) or is_call(moved, _SHORTENS)
                ):
                    yield removing(seen.script, 3.9, moved)
                    continue
                edits = _put_behind(seen.script, node, node.body[-count:])
                values = {"line": moved.lineno, "loop": node.lineno}
                yield Proposal("out_of_loop", 3.7 + count * 0.2, edits, values)


def _publishes(loop: ast.AST) -> bool:
    """Whether a loop publishes by itself: another publish in it would overrule that."""
    return any(callee(one).endswith(".publish") for one in ast.walk(loop))


def _out_of_branches(seen: Situation) -> Iterator[Proposal]:
    """Yield what ends a branch moved behind it, so that it runs whatever the test says."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.If) or node.lineno not in seen.ledger.ran:
            continue
        outer: ast.stmt = node
        while isinstance(above := seen.script.parent(outer), ast.If) and any(
            one is outer for one in above.orelse
        ):
            outer = above  # an elif
        for branch in (node.body, node.orelse):
            sent = [one for one in branch if is_call(one, ("publish",))]
            for one in {id(each): each for each in (*sent, *branch[-1:])}.values() if len(branch) > 1 else ():
                if isinstance(one, ast.Expr):
                    values = {"line": one.lineno, "loop": outer.lineno}
                    yield Proposal("out_of_branch", 2.4, _put_behind(seen.script, outer, [one]), values)


def _into_ends(seen: Situation) -> Iterator[Proposal]:
    """Yield a stop, a return or an assignment behind an `if`, moved into it: it was meant for that case only."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.If) or node.orelse or node.lineno not in seen.ledger.ran:
            continue
        for one in seen.script.behind(node)[:1]:
            ends = isinstance(one, ast.Return | ast.Break) or is_call(one, ENDS)
            if ends or isinstance(one, ast.Assign | ast.AugAssign):
                edits = _put_behind(seen.script, node.body[-1], [one])
                values = {"line": one.lineno, "loop": node.lineno}
                yield Proposal("into_if", 2.0 if ends else 2.6, edits, values)


def _put_behind(script: ParsedScript, other: ast.stmt, moved: list[ast.stmt]) -> tuple[Edit, ...]:
    """Return the edits that move statements of a line each behind another one; none if one has more lines."""
    texts = [script.source(one) for one in moved]
    if any("\n" in text for text in texts):
        return ()
    return (*(script.removed(one) for one in moved), script.inserted_after(other, *texts))


def _counters(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a count for a counter that nothing changes."""
    tests = {
        dotted(name): node
        for node in ast.walk(seen.script.tree)
        if isinstance(node, ast.While | ast.If)
        for name in ast.walk(node.test)
        if dotted(name)
    }
    for name, node in tests.items():
        sets = [one for one in known if one.target == name]
        if node.lineno not in seen.ledger.ran or not sets or not isinstance(sets[0].value, ast.Constant):
            continue
        inside = range(node.lineno, (node.end_lineno or node.lineno) + 1)
        if isinstance(node, ast.While) and not any(one.statement.lineno in inside for one in sets):
            edit = seen.script.inserted_after(node.body[-1], f"{name} += 1")
            yield Proposal("counter", 1.5, (edit,), {"line": node.lineno, "name": name})
        elif isinstance(node, ast.If) and len(sets) == 1 and number_of(sets[0].value) == 0.0:
            own = [one.statement for one in known if one.target.startswith("self.")]
            blocks = [seen.script.block_of(one) for one in own if isinstance(seen.script.parent(one), ast.If)]
            for block in blocks if name.startswith("self.") else ():  # what else sets, when a step is over
                last = next(one for one in reversed(block) if one in own)
                values = {"line": last.lineno, "name": name, "sentence": "counter_of_steps"}
                edit = seen.script.inserted_after(last, f"{name} += 1")
                yield Proposal("counter", 1.5, (edit,), values)


def _unpublished(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the publish of a message that is filled and never sent: in the loop behind it, or at once."""
    makers = [one for one in known if isinstance(one.value, ast.Call)]
    publishers = [one.target for one in makers if dotted(one.value.func).endswith("create_publisher")]  # type: ignore[attr-defined]
    lasts = {
        (_message_of(one), function_around(seen.script, one.statement)): one.statement
        for one in known
        if one.target.endswith((".linear.x", ".angular.z"))
    }
    for one in makers:
        key = (one.target, function_around(seen.script, one.statement))
        if publishers and key not in lasts and dotted(one.value.func) == seen.twist:  # type: ignore[attr-defined]
            yield from _unsent_stop(seen, publishers[0], one.target, one.statement)
    for (message, function), last in lasts.items() if publishers else ():
        if _is_sent(seen.script, message, function):
            continue
        line = f"{publishers[0]}.publish({message})"
        values = {"line": last.lineno, "name": message}
        behind = seen.script.behind(last)
        for loop in (one for one in behind if isinstance(one, _Loops)):
            edit = seen.script.inserted_before(loop.body[0], line)
            yield Proposal("publish_in_loop", 0.9, (edit,), {**values, "loop": loop.lineno})
        shown = [
            call for call in calls_of(seen.script, "print") if [dotted(one) for one in call.args] == [message]
        ]
        for call in shown:
            new = f"{publishers[0]}.publish"
            yield replacing(seen.script, "name", 0.8, call.func, new, old="print")
        wait = next((one for one in behind if _is_wait(one)), None)
        if wait is not None and not _is_short(wait):
            edits = (
                seen.script.inserted_before(wait, *_repeated(seen.script, line, wait)),
                seen.script.removed(wait),
            )
            yield Proposal("publish_in_loop", 0.95, edits, {**values, "loop": wait.lineno})
        yield Proposal("publish", 1.0, (seen.script.inserted_after(last, line),), values)


def _unsent_stop(seen: Situation, publisher: str, message: str, made: ast.stmt) -> Iterator[Proposal]:
    """Yield the publish of a message that is made, left as it is and never sent."""
    if not _is_sent(seen.script, message, function_around(seen.script, made)):
        edit = seen.script.inserted_after(made, f"{publisher}.publish({message})")
        yield Proposal("publish", 0.9, (edit,), {"line": made.lineno, "name": message})


def _is_wait(statement: ast.stmt) -> bool:
    return is_call(statement, ("sleep",)) and bool(statement.value.args)  # type: ignore[attr-defined]


def _is_short(wait: ast.stmt) -> bool:
    """Whether a wait is that of a loop around it, which sends again by itself."""
    seconds = number_of(wait.value.args[0])  # type: ignore[attr-defined]
    return seconds is not None and seconds < _LONG_PAUSE_S


def _repeated(script: ParsedScript, line: str, wait: ast.stmt) -> tuple[str, ...]:
    """Return the loop that sends for as long as a wait lasts."""
    call = getattr(wait, "value", None)
    assert isinstance(call, ast.Call)
    seconds = script.source(call.args[0])
    if not isinstance(call.args[0], ast.Name | ast.Constant | ast.Attribute):
        seconds = f"({seconds})"
    return (
        f"for _ in range(round({seconds} / {_SHORT_PAUSE})):",
        f"    {line}",
        f"    {script.source(call.func)}({_SHORT_PAUSE})",
    )


def _pauses(seen: Situation) -> Iterator[Proposal]:
    """Yield a pause in a loop that publishes without one."""
    for driven in seen.distinct:
        if driven.motion.waits or driven.motion.times < _BURST:
            continue
        for statement in seen.script.statements_on(driven.motion.line):
            if isinstance(seen.script.parent(statement), _Loops):
                pause = seen.script.inserted_after(statement, "time.sleep(0.1)")
                edits = (pause, *imported(seen.script, "time"))
                yield Proposal("pause", 2.0, edits, {"line": statement.lineno})


def _sent_once(seen: Situation) -> Iterator[Proposal]:
    """Yield a loop around a publish and the wait behind it, where turtlesim dropped the command before its end."""
    for driven in seen.distinct:
        for statement in seen.script.statements_on(driven.motion.line) if driven.is_held else ():
            wait = next(iter(seen.script.behind(statement)), statement)
            if not is_call(statement, ("publish",)) or not _is_wait(wait):
                continue
            lines = _repeated(seen.script, seen.script.source(statement), wait)
            edits = (
                seen.script.inserted_before(statement, *lines),
                seen.script.removed(statement),
                seen.script.removed(wait),
            )
            yield Proposal("sent_once", 0.8, edits, {"line": statement.lineno})


def _removed(seen: Situation) -> Iterator[Proposal]:
    """Yield the script without a line that drives on, or that ends what should go on."""
    for motion in {one.motion.lines: one.motion for one in seen.driven[-_LAST:]}.values():
        for line, _, _ in motion.stack:
            for statement in seen.script.statements_on(line):
                if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
                    yield removing(seen.script, 4.5, statement)
    for node in ast.walk(seen.script.tree):
        ends = isinstance(node, ast.Break | ast.Return | ast.Continue) or (
            isinstance(node, ast.stmt) and is_call(node, (*ENDS, "rclpy.spin"))
        )
        inside = isinstance(node, ast.stmt) and not isinstance(seen.script.parent(node), ast.Module | ast.Try)
        if (
            isinstance(node, ast.stmt)
            and ends
            and inside
            and node.lineno in seen.ledger.ran
            and _has_rest(seen, node)
        ):
            yield removing(seen.script, 2.3, node)
    heads = [one for one in seen.script.tree.body if isinstance(one, ast.If)]
    guards = [one for one in heads if "__name__" in seen.script.source(one.test)]
    if len(guards) > 1:
        edit = seen.script.removed(guards[0])
        yield Proposal("two_scripts", 0.5, (edit,), {"line": guards[0].lineno, "other": guards[1].lineno})


def _has_rest(seen: Situation, statement: ast.stmt) -> bool:
    """Whether something else was to come behind a statement: in its loop or callback, or in its block."""
    around = [one for one in seen.script.around(statement) if isinstance(one, (*_Loops, ast.If))]
    return (
        bool(around)
        or any(not is_call(one, ENDS) for one in seen.script.behind(statement))
        or _is_callback(seen, statement)
    )


def _is_callback(seen: Situation, statement: ast.stmt) -> bool:
    makers = calls_of(seen.script, "create_timer", "create_subscription")
    function = function_around(seen.script, statement)
    return function is not None and function.name in named_in(makers)


def _negated(seen: Situation) -> Iterator[Proposal]:
    """Yield a test without the `not` with which it was never true."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.If | ast.While) or not isinstance(node.test, ast.UnaryOp):
            continue
        ran = seen.ledger.ran
        if sum(one.target == dotted(node.test.operand) for one in assignments(seen.script)) > 1:
            continue  # a state: where it changes may be wrong
        if isinstance(node.test.op, ast.Not) and node.lineno in ran and node.body[0].lineno not in ran:
            new = seen.script.source(node.test.operand)
            yield replacing(seen.script, "comparison", 0.7, node.test, new)


def _sleeps_in_callbacks(seen: Situation) -> Iterator[Proposal]:
    """Yield a timer's callback without a sleep: while it sleeps, neither the timer nor anything else is served."""
    callbacks = named_in(calls_of(seen.script, "create_timer"))
    for call in calls_of(seen.script, "sleep"):
        statement, function = seen.script.parent(call), function_around(seen.script, call)
        if isinstance(statement, ast.Expr) and function is not None and function.name in callbacks:
            values = {"line": call.lineno, "old": seen.script.source(call), "name": function.name}
            yield Proposal("sleeping", 1.2, (seen.script.removed(statement),), values)
