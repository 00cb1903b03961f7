"""Changes of what lets callbacks, threads and coroutines run: spins, executors, starts, awaits."""

import ast
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import RunStatus
from grader.edits.situation import Proposal, Situation, replacing
from grader.edits.slices import (
    NameSet,
    assignments,
    callee,
    calls_of,
    dotted,
    function_around,
    functions_of,
    imported,
    is_call,
    is_method,
    makes_node,
    named_in,
)
from grader.edits.tree import Edit, ParsedScript

ENDS: Final = ("shutdown", "cancel", "destroy_node", "exit", "destroy_timer", "destroy_publisher")
_Loops: Final = (ast.For, ast.While)
SPINS: Final = ("spin", "spin_once", "spin_until_future_complete")
_CALLBACKS: Final = ("create_timer", "create_subscription", "create_service")
_TIMEOUT: Final = "timeout_sec=0.01"


def spin_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of what lets callbacks, threads and coroutines run."""
    known = assignments(seen.script)
    yield from _spun_once(seen)
    yield from _early(seen)
    yield from _executors(seen, known)
    yield from _other_nodes(seen, known)
    yield from _without_timeout(seen)
    yield from _rates(seen, known)
    yield from _deaf(seen)
    yield from _at_the_end(seen, known)
    yield from _threads(seen, known)
    yield from _awaited(seen)
    yield from _cancelled(seen, known)


def node_name(script: ParsedScript) -> str:
    """Return the name that the script has for its node."""
    return next(iter(_nodes(script)), "node()")


def _nodes(script: ParsedScript) -> list[str]:
    """Return the names of the script's nodes, in the order in which they are made."""
    return [one.target for one in assignments(script) if makes_node(script, one)]


def _ran(seen: Situation, call: ast.Call) -> bool:
    return call.lineno in seen.ledger.ran


def _spun_once(seen: Situation) -> Iterator[Proposal]:
    """Yield `spin` for a `spin_once` outside of any loop."""
    ended = seen.outcome.status is RunStatus.FINISHED
    for call in calls_of(seen.script, "spin_once") if ended else ():
        if not any(isinstance(one, _Loops) for one in seen.script.around(call)) and call.args:
            name = seen.script.source(call.args[0])
            edit = seen.script.replaced(call, f"rclpy.spin({name})")
            yield Proposal("spun_once", 1.0, (edit,), {"line": call.lineno, "name": name})


def _early(seen: Situation) -> Iterator[Proposal]:
    """Yield a spin moved behind what stands behind it, or that moved before the `try` around the spin."""
    for call in calls_of(seen.script, "spin"):
        spin = seen.script.parent(call)
        if not isinstance(spin, ast.Expr) or not _ran(seen, call):
            continue
        outer: ast.stmt = spin
        while not (behind := _behind(seen.script, outer)):
            above = seen.script.parent(outer)
            if not isinstance(above, ast.Try):
                break
            outer = above
        if not behind:
            continue
        values = {"line": spin.lineno, "other": behind[-1].lineno}
        texts = [seen.script.source(one) for one in behind]
        if outer is spin:
            moved = (
                seen.script.removed(spin),
                seen.script.inserted_after(behind[-1], seen.script.source(spin)),
            )
            yield Proposal("spun_early", 0.9, moved, values)
        elif not any("\n" in text for text in texts):
            edits = (
                seen.script.inserted_before(outer, *texts),
                *(seen.script.removed(one) for one in behind),
            )
            yield Proposal("spun_early", 0.9, edits, values)


def _behind(script: ParsedScript, statement: ast.stmt) -> list[ast.stmt]:
    """Return the statements behind one in its block, without those that end the program."""
    return [one for one in script.behind(statement) if not is_call(one, ENDS)]


def _executors(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a node for an executor that has none."""
    given = {dotted(call.func).rpartition(".")[0] for call in calls_of(seen.script, "add_node")}
    for one in known:
        called = callee(one.value)
        if called.endswith("Executor") and one.target not in given:
            new = f"{one.target}.add_node({node_name(seen.script)})"
            values = {"line": one.statement.lineno, "name": one.target, "new": new}
            yield Proposal("start", 0.5, (seen.script.inserted_after(one.statement, new),), values)


def _other_nodes(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield another node of the script for the one that is spun."""
    nodes = _nodes(seen.script)
    for call in calls_of(seen.script, "spin"):
        old = dotted(call.args[0]) if call.args else ""
        for new in nodes if old in nodes else ():
            if new != old:
                yield replacing(seen.script, "name", 1.0, call.args[0], new)


def _without_timeout(seen: Situation) -> Iterator[Proposal]:
    """Yield the time after which each `spin_once` gives up, where the script was held up in one."""
    calls = [call for call in calls_of(seen.script, "spin_once") if len(call.args) == 1 and not call.keywords]
    first = next((call for call in calls if _ran(seen, call)), None)
    if first is not None and seen.outcome.status is RunStatus.STALLED:
        edits = tuple(
            Edit(end, end, f", {_TIMEOUT}") for end in (seen.script.span(one)[1] - 1 for one in calls)
        )
        old = seen.script.source(first)
        values = {"line": first.lineno, "old": old, "new": f"{old[:-1]}, {_TIMEOUT})"}
        yield Proposal("stalls", 0.9, edits, values)


def _rates(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield `time.sleep` for a rate that the script was held up in: only another thread's spin ends its sleep."""
    rates = {
        one.target: one.value.args[0]
        for one in known
        if isinstance(one.value, ast.Call) and callee(one.value).endswith("create_rate") and one.value.args
    }
    calls = [
        (call, rates[name])
        for call in calls_of(seen.script, "sleep")
        if (name := dotted(call.func).removesuffix(".sleep")) in rates
    ]
    first = next((call for call, _ in calls if _ran(seen, call)), None)
    if first is not None and seen.outcome.status is RunStatus.STALLED:
        news = [(call, f"time.sleep(1 / {seen.script.source(hertz)})") for call, hertz in calls]
        edits = [seen.script.replaced(call, new) for call, new in news]
        values = {"line": first.lineno, "old": seen.script.source(first), "new": news[0][1]}
        yield Proposal("stalls", 0.8, (*edits, *imported(seen.script, "time")), values)


def _deaf(seen: Situation) -> Iterator[Proposal]:
    """Yield a look for messages in the loops that wait or drive, where nothing spins."""
    if not seen.outcome.hears or any(_ran(seen, call) for call in calls_of(seen.script, *SPINS)):
        return
    callbacks = named_in(calls_of(seen.script, *_CALLBACKS))
    name = node_name(seen.script)
    edits: list[Edit] = []
    first = 0
    for loop in ast.walk(seen.script.tree):
        function = function_around(seen.script, loop)
        if not isinstance(loop, ast.While) or (function is not None and function.name in callbacks):
            continue
        spin = f"rclpy.spin_once({'self' if is_method(seen.script, loop) else name}, timeout_sec="
        sleep = next((one for one in loop.body if is_call(one, ("sleep",)) and one.value.args), None)  # type: ignore[attr-defined]
        if sleep is None:
            edits.append(seen.script.inserted_before(loop.body[0], f"{spin}0.01)"))
        else:
            seconds = seen.script.source(sleep.value.args[0])  # type: ignore[attr-defined]
            edits.append(seen.script.replaced(sleep, f"{spin}{seconds})"))
        first = min(first or loop.lineno, loop.lineno)
    if edits:
        yield Proposal("spin_once", 1.9, tuple(edits), {"line": first})


def _at_the_end(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a spin at the end of a script that ended while its node had something to wait for."""
    name = node_name(seen.script)
    listens = bool(calls_of(seen.script, *_CALLBACKS))
    made = [one.statement for one in known if one.target == name]
    if (
        calls_of(seen.script, "spin")
        or seen.outcome.status is not RunStatus.FINISHED
        or not made
        or not (listens or "alive" in seen.lost)
    ):
        return
    block = seen.script.block_of(made[-1])
    ends = [one for one in block if is_call(one, ("destroy_node", "shutdown"))]
    spin = f"rclpy.spin({name})"
    edit = seen.script.inserted_before(ends[0], spin) if ends else seen.script.inserted_after(block[-1], spin)
    yield Proposal("spin", 2.2, (edit,), {"line": made[-1].lineno, "name": name})


def _threads(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the start of a thread that is made and not started, and a thread for what runs before it is made."""
    started = {dotted(call.func).rpartition(".")[0] for call in calls_of(seen.script, "start")}
    kept = [(one.statement, one.value, one.target) for one in known]
    lone = [(one, one.value, "") for one in ast.walk(seen.script.tree) if isinstance(one, ast.Expr)]
    for statement, value, name in (*kept, *lone):
        if not isinstance(value, ast.Call) or not dotted(value.func).endswith(("Thread", "Timer")):
            continue
        source = name or seen.script.source(value)
        values = {"line": statement.lineno, "name": source, "new": f"{source}.start()"}
        if not name:
            yield Proposal("start", 0.9, (seen.script.replaced(value, f"{source}.start()"),), values)
        elif name not in started:
            yield Proposal("start", 0.9, (seen.script.inserted_after(statement, f"{name}.start()"),), values)
        for given in value.keywords:
            if given.arg == "target" and isinstance(given.value, ast.Call):
                yield _handed_over(seen.script, given.value)


def _handed_over(script: ParsedScript, call: ast.Call) -> Proposal:
    """Return the proposal that hands a function to a thread, in the place of what it returns."""
    arguments = [script.source(one) for one in call.args]
    function = script.source(call.func)
    new = f"{function}, args=({', '.join(arguments)},)" if arguments else function
    values = {"line": call.lineno, "old": script.source(call), "new": new}
    return Proposal("name", 0.4, (script.replaced(call, new),), values)


def _awaited(seen: Situation) -> Iterator[Proposal]:
    """Yield what runs the coroutines that the script only makes."""
    makers = {one.name for one in ast.walk(seen.script.tree) if isinstance(one, ast.AsyncFunctionDef)}
    edits: list[Edit] = []
    values: dict[str, object] = {}
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
            continue
        name = dotted(node.value.func)
        if name != "asyncio.sleep" and name.rpartition(".")[2] not in makers:
            continue
        old = seen.script.source(node)
        inside = isinstance(function_around(seen.script, node), ast.AsyncFunctionDef)
        new = f"await {old}" if inside else f"asyncio.run({old})"
        edits += [seen.script.replaced(node, new), *([] if inside else imported(seen.script, "asyncio"))]
        values = values or {"line": node.lineno, "old": old, "new": new}
    if edits:
        yield Proposal("await", 0.4, tuple(dict.fromkeys(edits)), values)


def _cancelled(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the cancelling of a timer, where callbacks make ever more of them."""
    for one in known:
        arguments = one.value.args if isinstance(one.value, ast.Call) else []
        if len(arguments) < 2 or not callee(one.value).endswith("create_timer"):
            continue
        function = function_around(seen.script, one.statement)
        if function is not None and function.name == "__init__":
            continue
        for node in functions_of(seen.script):
            if node.name == dotted(arguments[1]).rpartition(".")[2]:
                edit = seen.script.inserted_before(node.body[0], f"{one.target}.cancel()")
                yield Proposal("cancel", 2.0, (edit,), {"line": one.statement.lineno, "name": one.target})
