"""Code that never runs, runs at the wrong time, or is ended too early; and topics that nobody hears."""

import difflib
import itertools
import re
from collections.abc import Iterator
from typing import Final

from grader.checks.causes.searched import CLOCK, SHOWS, Searched, is_repeated, itself
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import error_caught, not_called, noted
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number
from grader.messages.script import NOT_ZERO, Callback, Definition, ScriptText

_HARMLESS: Final = r"(?i)log|print|wait|sleep|stop|clean|close|exit|shut|finish|done|handler|signal|__"
"""Names of functions that may be empty without harm to a motion."""
_MOTION: Final = rf"\.(linear\.x|angular\.z) ?[-+]?{NOT_ZERO}"
_AXES: Final = (r"linear\.x", r"angular\.z")
_ENDS: Final = re.compile(r"\b(shutdown|destroy_timer|destroy_node|cancel|exit)\(|^raise SystemExit")
_DIGITS: Final = str.maketrans("lIOo", "1100")
_TURNS: Final = r"(?i)turn(?!le)|rotat|spin|left|right|corner|zhuan|转"
_MOST_DEAD: Final = 20  # functions that are looked at, each with all that it would run
_WANTED: Final = {
    "no_turns": rf"\.angular\.z ?{NOT_ZERO}",
    "no_drive": rf"\.linear\.x ?{NOT_ZERO}",
    "only_stops": rf"\.(linear\.x|angular\.z) ?{NOT_ZERO}",
}
"""What a script does somewhere that did not happen; of the other mistakes, a publish."""
_ASKED: Final = r"\bself\.(\w+) is None\b|\bnot self\.(\w+)(?!\()\b"
"""What a function waits for."""
_VALUE: Final = r"\"\"|True|False|\d+"
_LAST: Final = r"(?i)(done|stop|fin|end|idle|over|exit|wait|init|start|arriv|reach)"
"""How states begin that need no branch of their own."""
_STATE: Final = r"\b\w*(?:state|status|mode|phase|stage)\w*"
_NAMED: Final = r"(?<![\w.])((?:self\.)?\w*(?:state|status|mode|phase|stage)\w*)"
_STATE_SET: Final = re.compile(_NAMED + r" *= *[\"'](\w{1,40})[\"']")
_STATE_ASKED: Final = re.compile(_NAMED + r" *== *[\"'](\w{1,40})[\"']")
_NEAR: Final = 0.8
_MOST_STATES: Final = 20  # each that is asked for is compared with all of them


def deaf_loop(seen: Searched) -> Mistake | None:
    """Find a loop that waits for what a subscription's callback keeps, in which nothing spins."""
    heard = [callback.name for callback in seen.script.callbacks("subscription")]
    kept = {name for one in heard for name in seen.script.attributes_set_in(one)}
    others = [callback.name for callback in seen.script.callbacks("timer")] + heard
    if not kept or seen.script.lines_with(r"\bThread\(|Executor\("):
        return None
    for line, found in seen.script.matches(r"\bwhile\b(.*)$"):
        waited = [name for name in _read_in(found[1], seen.script) if name in kept]
        if waited and not seen.script.spins(line) and seen.script.function_around(line) not in others:
            return mistake("deaf_loop", line=line, name=waited[0])
    return None


def _read_in(condition: str, script: ScriptText) -> list[str]:
    """Return the attributes of ``self`` that a condition reads, itself or in the methods that it calls."""
    names = re.findall(r"\bself\.(\w+)", condition)
    called = (script.definition(name) for name in re.findall(r"\bself\.(\w+)\(", condition))
    blocks = ("\n".join(script.block(made.line)) for made in called if made is not None)
    return names + [name for block in blocks for name in re.findall(r"\bself\.(\w+)", block)]


def error_hides_rest(seen: Searched) -> Mistake | None:
    """Find an error that something caught, so that what follows it did not run; one of a log hardly matters."""
    caught = noted(seen.run.outcome, "caught") or ""
    line = re.match(r"line (\d{1,6}): ", caught)
    written = seen.script.lines[int(line[1]) - 1 : int(line[1])] if line else []
    if any(not re.search(rf"{SHOWS}|get_logger\(", one) for one in written):
        return error_caught(seen.run)
    return None


def other_axis(seen: Searched) -> Mistake | None:
    """Find a speed along, or about, an axis in which a car on the ground cannot move."""
    for line, found in seen.script.matches(r"^[^,]*?\.(angular\.[xy]|linear\.z) ?=(?!=)(.*)$"):
        if value_of(found[2].rpartition("=")[2].partition(";")[0].strip(), seen.script) != 0.0:
            return mistake("other_axis", line=line, name=found[1])
    return None


def loop_for_spin(seen: Searched) -> Mistake | None:
    """Find an endless loop that only keeps a script running, in which nothing ever calls its callbacks."""
    script = seen.script
    callbacks = [callback.name for callback in script.callbacks("timer", "subscription", "service")]
    if not callbacks or script.lines_with(r"spin|Executor\("):
        return None
    for line in script.lines_with(r"^[ \t]*while \(?(True|1|([\w.]+\.)?ok\( ?\))\)? ?:"):
        acts = any(re.search(r"\.publish\(|\bget_logger\(|\bbreak\b", text) for text in script.block(line))
        if not acts and script.function_around(line) not in callbacks:
            return mistake("loop_for_spin", line=line, name=callbacks[0])
    return None


def empty_function(seen: Searched) -> Mistake | None:
    """Find functions in which nothing but ``pass`` stands, and that the script calls."""
    empty = []
    heard = {callback.name for callback in seen.script.callbacks("subscription", "service")}
    for line in seen.script.lines_with(r"^[ \t]*def \w+ ?\("):
        name = seen.script.lines[line - 1].split("def ")[1].partition("(")[0].strip()
        behind = seen.script.lines[line - 1].rpartition(":")[2].strip()
        body = [text for _, text in seen.script.body(line) if text != '""'] or [behind]
        if (
            body == ["pass"]
            and seen.script.definition(name) is not None  # else another one may stand in its place
            and seen.script.calls(name)
            and name not in heard
            and not re.search(_HARMLESS, name)
        ):
            empty.append((line, name))
    if not empty:
        return None
    lines = ", ".join(str(line) for line, _ in empty[:4])
    return mistake("empty_function", lines=lines, names=", ".join(f"{name}()" for _, name in empty[:4]))


def removes_in_loop(seen: Searched) -> Mistake | None:
    """Find a list that loses items while a loop goes through it."""
    for loop in seen.script.lines_with(r"^[ \t]*for \w+ in [\w.]+ ?:"):
        name = seen.script.lines[loop - 1].partition(" in ")[2].rpartition(":")[0].strip()
        for line, text in enumerate(seen.script.block(loop), start=loop):
            removes = rf"(?<![\w.]){re.escape(name)}\.(remove|pop)\(|\bdel {re.escape(name)}\["
            nexts = "".join(seen.script.lines[line : line + 1])
            if re.search(removes, text) and not re.match(r"[ \t]*(break|return)\b", nexts):
                return mistake("removes_in_loop", line=line, loop=loop, name=name)
    return None


def leaves_loop(seen: Searched) -> Mistake | None:
    """Find a ``return`` or ``break`` that ends a loop in its first round; ``while True`` may be meant so."""
    for loop in seen.script.lines_with(r"^[ \t]*(for\b|while\b(?! ?\(?(True|1|rclpy\.ok\(\))\)? ?:))"):
        goes_on = any(re.search(r"\bcontinue\b", text) for text in seen.script.block(loop))
        for line, text in seen.script.body(loop):
            found = re.match(r"(return|break)\b", text)
            if found is not None and not goes_on:
                return mistake("leaves_loop", line=line, loop=loop, word=found[1])
    return None


def branch_without_publish(seen: Searched) -> Mistake | None:
    """Find a branch of a timer's callback that fills a new message, behind which no publish can be reached."""
    field = "linear.x" if seen.mistake.code == "no_drive" else "angular.z"
    script = seen.script
    for timer in script.functions_called_back("timer"):
        block = script.block(timer.begins)
        for line, text in enumerate(block, start=timer.begins):
            filled = re.match(rf"[ \t]*(\w+)\.{field} ?{NOT_ZERO}", text)
            if filled is None or not any(re.match(rf"[ \t]*{filled[1]} ?= ?Twist\(", one) for one in block):
                continue
            later = [at for at in script.lines_with(r"\.publish\(|\w\(.*\b" + filled[1]) if at > line]
            if script.lines_with(r"\.publish\(") and not any(script.is_behind(at, line) for at in later):
                return mistake("branch_without_publish", line=line, callback=timer.name, field=field)
    return None


def never_sent(seen: Searched) -> Mistake | None:
    """Find a function that fills a message of its own and neither publishes it nor hands it on."""
    script = seen.script
    fields = {"no_turns": r"angular\.z", "no_drive": r"linear\.x"}.get(
        seen.mistake.code, r"linear\.x|angular\.z"
    )
    filled = script.matches(rf"^[ \t]+(\w+)\.({fields}) ?{NOT_ZERO}")
    for line, found in itertools.islice(filled, _MOST_DEAD):
        made = script.definition(function := script.function_around(line))
        block = script.block(made.line) if made is not None and script.calls(function) else []
        own = any(re.match(rf"[ \t]*{found[1]} ?= ?Twist\(", text) for text in block)
        used = rf"[(,=\[] ?{found[1]} ?[),\]]|\b(return|yield) {found[1]}\b|= ?{found[1]}$"
        read = rf"\b{found[1]}\.(linear|angular)\.\w\b(?! ?=(?!=))"
        if own and not any(re.search(rf"{used}|{read}", text) for text in block):
            call = f"{script.publisher_name}.publish({found[1]})"
            return mistake("never_sent", line=line, field=found[2], function=function, call=call)
    return None


def timer_repeats(seen: Searched) -> Mistake | None:
    """Find a timer that a callback creates, whose own callback creates the next one and cancels none.

    Outside of such a chain a timer that a callback creates may be meant to go on.
    """
    script = seen.script
    timers = script.callbacks("timer")[:_MOST_DEAD]
    reached = script.reached_from(timer.begins for timer in timers)
    for timer in timers:
        maker = script.definition(script.function_around(timer.created))
        if maker is None or maker.line not in reached:
            continue
        runs = "\n".join(text for at in script.reached_from([timer.begins]) for text in script.block(at))
        if "create_timer(" in runs and not re.search(r"\b(cancel|destroy_timer)\(", runs):
            return mistake("timer_repeats", line=timer.created, callback=timer.name)
    return None


def skips_rest(seen: Searched) -> Mistake | None:
    """Find a ``continue`` that ends each round of a loop, whatever happens, before what stands behind it."""
    for loop in seen.script.lines_with(r"^[ \t]*(for|while)\b"):
        body = seen.script.body(loop)
        for (line, text), (behind, _) in itertools.pairwise(body):
            if text == "continue":
                return mistake("skips_rest", line=line, behind=behind)
    return None


def no_loop(seen: Searched) -> Mistake | None:
    """Recognise a script that writes a part of the figure once, and has no loop to repeat it."""
    count, item = seen.findings.measures.get("sides"), seen.assignment.item_on("sides")
    wanted = item.low if item is not None else None
    if count is None or not wanted or not 0 < count.value < wanted or wanted % count.value:
        return None
    counted = seen.script.lines_with(r"\bcreate_(timer|subscription)\(|\bimport threading\b") + [
        line
        for line in seen.script.lines_with(r"^[ \t]*for\b")
        if sum(bool(re.search(r"\.publish\(", text)) for text in seen.script.block(line)) != 1
    ]
    counted += seen.script.lines_with(r"[\[(].*\bfor \w+ in\b")
    waiting = seen.script.lines_with(rf"^[ \t]*while\b.*({CLOCK}|\bok\(|time(?!s\b))")
    left = seen.script.lines_with(r"^[ \t]*(return$|raise\b|(\w+\.)*_?exit\(|quit\()")
    if counted or left or len(waiting) != len(seen.script.lines_with(r"^[ \t]*while\b")):
        return None
    values = {"count": f"{count.value:g}", "sides": f"{wanted:g}", "times": f"{wanted / count.value:g}"}
    return mistake("no_loop", **values)


def timer_stops(seen: Searched) -> Mistake | None:
    """Find the timer whose callback only stops, beside another one that drives."""
    timers = seen.script.callbacks("timer")
    stops, drives = [], []
    for timer in timers:
        body = "\n".join(seen.script.block(timer.begins)[1:])
        if re.search(_MOTION, body):
            drives.append(timer)
        elif re.search(r"\.publish\(", body):
            stops.append(timer)
    if len(timers) < 2 or not stops or not drives:
        return None
    return mistake("timer_stops", line=stops[0].created, name=stops[0].name)


def timers_overrule(seen: Searched) -> Mistake | None:
    """Find two timers of which one drives and the other turns: the faster replaces what the slower sends.

    Under a condition, or where a timer is cancelled, they may well take turns.
    """
    script = seen.script
    timers = script.callbacks("timer")
    known: list[tuple[float, str, bool]] = []
    for timer in timers if len(timers) == 2 else ():
        period_s = value_of((script.arguments(timer.created, "create_timer") or [""])[0], script)
        body = "\n".join(script.block(timer.begins)[1:])
        moves = [bool(re.search(_MOTION.replace(r"linear\.x|angular\.z", axis), body)) for axis in _AXES]
        takes_turns = re.search(r"\bif\b|\.cancel\(", body)
        if period_s is None or takes_turns or ".publish(" not in body or sum(moves) != 1:
            return None
        known.append((period_s, timer.name, moves[0]))
    if len(known) != 2 or known[0][2] == known[1][2]:
        return None
    (fast_s, fast, _), (_, slow, _) = sorted(known)
    return mistake("timers_overrule", fast=fast, slow=slow, period=number(fast_s, "s", 4))


def spin_once(seen: Searched) -> Mistake | None:
    """Find a ``spin_once`` that stands in no loop; where there were commands, callbacks must have sent them."""
    ran = seen.mistake.code in {"no_turns", "too_short", "turn_too_short"}
    calls_back = seen.script.lines_with(r"\bcreate_(timer|subscription|service)\(")
    if ran and not calls_back:
        return None
    once = seen.script.lines_with(r"\bspin_once\(")
    loose = [line for line in once if not is_repeated(line, seen.script)]
    if not len(once) == len(loose) == 1 or seen.script.lines_with(r"\bspin\("):
        return None
    if ran and (seen.script.function_around(*loose) not in {"", "main"} or seen.script.works_after(*loose)):
        return None  # a loop may call the function, or the motion come from what is behind
    return mistake("spin_once", line=loose[0])


def ends_in_callback(seen: Searched) -> Mistake | None:
    """Find a call in a timer's callback that ends the timer or the program at the first tick."""
    if not seen.script.lines_with(r"\bspin"):
        return None  # then the callback never ran
    for timer in seen.script.callbacks("timer"):
        body = seen.script.body(timer.begins)
        always = itertools.takewhile(lambda one: not re.match(r"if\b|return\b|for\b|while\b", one[1]), body)
        ends = [line for line, text in always if _ENDS.search(text)]
        if ends:
            return mistake("ends_in_callback", lines=", ".join(map(str, ends)), name=timer.name)
    return None


def level_raised(seen: Searched) -> Mistake | None:
    """Find a level of a logger below which it shows nothing, above that of the message."""
    for line, found in seen.script.matches(r"\bset_(?:logger_)?level\(.*\b(WARN|WARNING|ERROR|FATAL)\b"):
        return mistake("level_raised", line=line, level=found[1])
    return None


def log_behind_spin(seen: Searched) -> Mistake | None:
    """Find a message that stands behind ``spin`` in the same function."""
    for spin in seen.script.lines_with(r"\bspin\("):
        around = seen.script.function_around(spin)
        for line in seen.script.lines_with(r"\bget_logger\(\)\.\w+\("):
            if line > spin and seen.script.function_around(line) == around:
                return mistake("log_behind_spin", line=line, spin=spin)
    return None


def uncalled(seen: Searched) -> Mistake | None:
    """Find a function that is named and not called; where no motion came, one that is called nowhere else."""
    named = seen.script.named_only
    loud = {"log_not_reached", "no_final_stop", "never_stops", "drove_on", "turned_on", "turn_missing"}
    name = "" if named is None else re.escape(named.name.rpartition(".")[2])
    called = seen.script.lines_with(rf"(?<!def )\b{name}\(") if name else []
    return None if called and seen.mistake.code not in loud else not_called(seen.run)


def lookalike(seen: Searched) -> Mistake | None:
    """Recognise a topic in which a letter stands for a digit, or that a namespace has changed."""
    topic = seen.assignment.world.cmd_vel_topic
    used = [one.name for one in seen.run.outcome.endpoints if one.kind == "publisher"]
    for name in used:
        if name != topic and name.translate(_DIGITS) == topic.translate(_DIGITS):
            wrong = next(one for one, other in zip(name, topic, strict=True) if one != other)
            right = next(other for one, other in zip(name, topic, strict=True) if one != other)
            return mistake("lookalike", used=name, topic=topic, wrong=wrong, right=right)
        lines = seen.script.lines_with(r"\bnamespace ?=")
        if lines and name != topic and name.endswith(topic):
            return mistake("in_namespace", line=lines[0], used=name, topic=topic)
    return None


def no_publish(seen: Searched) -> Mistake | None:
    """Find a timer's callback in a script that publishes nothing anywhere."""
    timers = seen.script.callbacks("timer")
    if not timers or seen.script.lines_with(r"\bpublish\b"):
        return None
    first = timers[0]
    last, _ = (seen.script.body(first.begins) or [(first.begins, "")])[-1]
    call = f"{seen.script.publisher or 'self.pub'}.publish({seen.script.twist_name_at(last) or 'msg'})"
    return mistake("no_publish", name=first.name, begins=first.begins, call=call)


def long_period(seen: Searched) -> Mistake | None:
    """Find a timer whose first tick comes after the end of the run."""
    for line, found in seen.script.matches(r"\bcreate_timer\( ?([^,()]+),"):
        period_s = value_of(found[1].strip(), seen.script)
        if period_s is not None and period_s * 1e9 > seen.run.outcome.duration_ns:
            return mistake("long_period", line=line, period=number(period_s, "s"))
    return None


def class_not_made(seen: Searched) -> Mistake | None:
    """Find a class that has the publisher, or logs, but of which the script creates no object."""
    for line in seen.script.lines_with(r"\bcreate_publisher\(|\bget_logger\("):
        for begins, head in seen.script.outwards(line):
            found = re.match(r"class (\w+)", head)
            if found is not None and not seen.script.lines_with(rf"(?<!class )\b{found[1]}\b"):
                return mistake("class_not_made", name=found[1], begins=begins)
    return None


def returns_before(seen: Searched) -> Mistake | None:
    """Find a ``return`` in the same block as the ``publish`` behind it."""
    for line in seen.script.lines_with(r"\.publish\("):
        owner = seen.script.owner_of(line)
        for at, text in seen.script.body(owner) if owner is not None else ():
            if at < line and re.match(r"return\b", text):
                return mistake("returns_before", line=at, publish=line)
    return None


def lambda_names(seen: Searched) -> Mistake | None:
    """Find a lambda for a callback that names the function and does not call it."""
    for line, found in seen.script.matches(r"\bcreate_\w+\(.*\blambda\b[^:]*: ?((?:\w+\.)?(\w+)) ?[,)]"):
        if seen.script.definition(found[2]) is not None:
            return mistake("not_called", line=line, name=found[1], call=f"{found[1]}()")
    return None


def waits_for_two(seen: Searched) -> Mistake | None:
    """Find a wait for more subscribers than there are."""
    lines = seen.script.lines_with(
        r"\bget_subscription_count\(\) ?(<= ?1|< ?[2-9]|!= ?[02-9])|\bcount_subscribers\([^)]*\) ?(<= ?1|< ?[2-9])"
    )
    lines += seen.script.lines_with(
        r"\bwhile not .*(get_subscription_count\(\)|count_subscribers\(.*\)) ?(> ?[1-9]|>= ?[2-9])"
    )
    return mistake("waits_for_two", line=lines[0]) if lines else None


def thread_runs_here(seen: Searched) -> Mistake | None:
    """Find a thread whose function is called, with brackets, where it should be handed over."""
    for line, found in seen.script.matches(r"\bThread\(.*\btarget ?= ?((?:\w+\.)*\w+)\( ?\)"):
        return mistake("thread_runs_here", line=line, name=found[1])
    return None


def thread_not_started(seen: Searched) -> Mistake | None:
    """Find a thread that would spin or publish in a script that starts none, or names ``start`` only."""
    script = seen.script
    made = r"(?:(?<![\w.])([\w.]+) ?= ?)?(?:(?:threading\.)?\b(Thread)|\bthreading\.(Timer))\("
    line, found = next(script.matches(made), (0, None))
    if found is None or script.lines_with(r"\.start\("):
        return None
    names = sorted(set(re.findall(r"\w+", " ".join(script.lines[line - 1 : line + 3]))))
    run = [one for name in names if (one := script.definition(name)) is not None]
    if "spin" not in names and not any(_moves(one, script) or script.spins(one.line) for one in run):
        return None
    kept = found[1] or f"{found[2] or found[3]}(...)"
    return mistake("thread_not_started", line=line, call=f"{kept}.start()")


def never_called(seen: Searched) -> Mistake | None:
    """Find a function that nothing calls or hands over, and that alone does what is missing."""
    script = seen.script
    dead = {} if script.lines_with(r"\bgetattr\(") else _dead(script)
    if noted(seen.run.outcome, "main_called") is not None:
        dead.pop("main", None)
    wanted = script.lines_with(_WANTED.get(seen.mistake.code, r"\.publish\("))
    if not dead:
        return None
    lost = wanted and all(script.function_around(line) in dead for line in wanted)
    asked = {one for _, found in script.matches(_ASKED) for one in found.groups() if one}
    for name in [name for name, called in dead.items() if not called][:_MOST_DEAD]:
        made = script.definition(name)
        if made is not None and _may_be_run(name, made.line, seen):
            continue
        blocks = (
            script.reached_from([made.line, *_handed_over(made.line, script)]) if made is not None else set()
        )
        does = any(line in script.span(begins) for line in wanted for begins in blocks)
        named = seen.mistake.code == "no_turns" and re.search(_TURNS, name) and _moves(made, script)
        if made is not None and ((lost and does) or named or _brings(made.line, asked, script)):
            return mistake("never_called", name=name, begins=made.line)
    return None


def _handed_over(begins: int, script: ScriptText) -> list[int]:
    """Return the first lines of the callbacks that the timers and subscriptions made in a function call."""
    inside = script.span(begins)
    return [one.begins for one in script.callbacks("timer", "subscription") if one.created in inside]


def _moves(made: Definition | None, script: ScriptText) -> bool:
    """Whether a function, or one that it calls, publishes."""
    blocks = script.reached_from([made.line]) if made is not None else set()
    return any(".publish(" in text for begins in blocks for text in script.block(begins))


def _may_be_run(name: str, begins: int, seen: Searched) -> bool:
    """Whether something outside of the script may call a function: an entry point, or a base class but Node."""
    owner = seen.script.owner_of(begins)
    if owner is None:
        return name == "main" or seen.assignment.package is not None
    base = re.match(r"[ \t]*class \w+ ?\(([^)]*)\)", seen.script.lines[owner - 1])
    return base is not None and base[1].strip() not in {"", "object", "Node", "rclpy.node.Node"}


def _brings(begins: int, asked: set[str], script: ScriptText) -> bool:
    """Whether a function stores its argument in one of the attributes `asked` for, and nothing else sets that."""
    block = script.block(begins)
    given = re.search(r"\((?:self ?, ?)?(\w+)[^,]*\) ?:", block[0])
    kept = re.findall(rf"\bself\.(\w+) ?= ?{given[1]}\b", "\n".join(block)) if given else []
    inside = script.span(begins)
    return any(
        all(line in inside for line, value in script.attributes_set.get(name, ()) if value != "None")
        for name in asked.intersection(kept)
    )


def _dead(script: ScriptText) -> dict[str, bool]:
    """Return the functions that nothing runs, each with whether another of them calls it."""
    users: dict[str, set[str]] = {found[1]: set() for _, found in script.matches(r"^[ \t]*def (\w+)")}
    names = set(users)  # and `users` is in the order of the script
    for at, line in enumerate(script.lines, start=1):
        for name in names.intersection(re.findall(r"\w+", re.sub(r"^[ \t]*def \w+", "", line))):
            users[name].add(script.function_around(at))
    alive = {name for name in names if "" in users[name] or name.startswith("__")}
    left = list(alive)
    while left:
        used = left.pop()
        new = {name for name in names - alive if used in users[name]}
        alive |= new
        left += new
    return {name: bool(users[name] - {name}) for name in users if name not in alive}


def never_filled(seen: Searched) -> Mistake | None:
    """Find what a function waits for and to which nothing but None is ever assigned."""
    if seen.script.lines_with(r"\bsetattr\("):
        return None
    for line, found in seen.script.matches(_ASKED):
        name = found[1] or found[2]
        given = seen.script.attributes_set.get(name, ())
        if given and all(value == "None" for _, value in given):
            return mistake("never_filled", line=line, name=name, given=given[0][0])
    return None


def kept_global(seen: Searched) -> Mistake | None:
    """Find a callback that keeps what it is given in a variable of its own, and not in that of the module."""
    for callback, _, kept in _kept(seen.script):
        name, block = kept[1], seen.script.block(callback.begins)
        if seen.script.lines_with(rf"^{name} ?=") and not any(
            re.search(rf"\bglobal\b.*\b{name}\b", one) for one in block
        ):
            return mistake("kept_global", name=name, callback=callback.name, begins=callback.begins)
    return None


def kept_local(seen: Searched) -> Mistake | None:
    """Find a callback that keeps what it is given in a variable of its own, and not in the node."""
    for callback, line, kept in _kept(seen.script):
        if _only_in_init(kept[1], seen.script):
            values = {"name": kept[1], "callback": callback.name, "written": kept[0].strip()}
            return mistake("kept_local", line=line, **values)
    return _state_in_vain(seen.script)


def _state_in_vain(script: ScriptText) -> Mistake | None:
    """Find a method that gives a state to a variable of its own, which it never reads, and not to the node's."""
    for line, found in script.matches(rf"^[ \t]+(\w+) ?= ?({_VALUE})$"):
        made = script.definition(script.function_around(line))
        asked = script.lines_with(rf"\b(if|elif|while)\b.*\bself\.{found[1]}(?!\w)")
        if made is None or not made.takes_self or not asked:
            continue
        block = "\n".join(script.block(made.line))
        if len(re.findall(itself(found[1]), block)) == len(re.findall(rf"{itself(found[1])} ?=(?!=)", block)):
            values = {"name": found[1], "callback": script.function_around(line)}
            return mistake(
                "kept_local", line=line, written=script.written(line).partition("#")[0].strip(), **values
            )
    return None


def compared_only(seen: Searched) -> Mistake | None:
    """Find a line that compares a state with what it should be set to, and does nothing with the result."""
    compared = list(seen.script.matches(rf"^[ \t]*([\w.]+) ?== ?({_VALUE}|None|[\w.]+)$"))
    heads = [found[1] for _, found in seen.script.matches(r"\b(?:if|elif|while)\b(.*)")] if compared else []
    asked = set(re.findall(r"[\w.]+", " ".join(heads)))
    for line, found in compared:
        before = "".join(seen.script.lines[line - 2 : line - 1]).rstrip()
        if before.endswith(("(", "[", ",", "\\", "=", "and", "or", "not")):
            continue  # the rest of a longer expression
        if found[1] in asked or re.search(r"\.(linear|angular)\.[xyz]$", found[1]):
            right = seen.script.written(line).partition("#")[0].strip().replace("==", "=", 1)
            return mistake("compares_for_assigns", line=line, right=right)
    return None


def _kept(script: ScriptText) -> Iterator[tuple[Callback, int, re.Match[str]]]:
    """Yield where a subscription's callback assigns what it is given to a plain name: callback, line and match."""
    for callback in script.functions_called_back("subscription"):
        block = script.block(callback.begins)
        given = re.search(r"\((?:self ?, ?)?(\w+)", block[0])
        if given is None:
            continue
        for line, text in enumerate(block[1:], start=callback.begins + 1):
            kept = re.match(rf"[ \t]*(\w+) ?= ?{given[1]}(\.\w+)*$", text)
            if kept and not _used_in(block[line - callback.begins + 1 :], kept[1]):
                yield callback, line, kept


def _used_in(lines: list[str], name: str) -> bool:
    """Whether lines compute with a plain name, so that it was meant as a variable of its own."""
    return any(re.search(itself(name), text) and not re.search(SHOWS, text) for text in lines)


def _only_in_init(name: str, script: ScriptText) -> bool:
    """Whether an attribute of the node is read, and assigned by ``__init__`` alone."""
    assigned = script.lines_with(rf"\bself\.{name}\b ?=(?!=)")
    read = script.lines_with(rf"\bself\.{name}\b(?! ?=(?!=))")
    return bool(read) and {script.function_around(line) for line in assigned} == {"__init__"}


def state_never_set(seen: Searched) -> Mistake | None:
    """Find a state that is written in one way where it is set, and in another where it is asked for."""
    script = seen.script
    if script.lines_with(rf"{_STATE} ?=(?!=)(?! ?(?:\"\"|None\b))|{_STATE} ?,[^=]*=(?!=)"):
        return None  # it may be set to anything
    written = [(line, script.written(line)) for line in script.lines_with(rf"{_STATE} ?[=!]=? ?\"\"")]
    known = {found[2] for _, text in written for found in _STATE_SET.finditer(text)}
    asked = {found[2] for _, text in written for found in _STATE_ASKED.finditer(text)}
    unset, unasked = sorted(asked - known), sorted(known - asked)
    branches = [one for one in unasked if not re.match(_LAST, one)]
    for line, text in written if len(known) + len(asked) <= _MOST_STATES else ():
        for found in _STATE_ASKED.finditer(text):
            only = len(unset) == len(branches) == 1
            near = _alike(found[2], unasked) or (branches if only else [])
            if found[2] in unset and near:
                return mistake("state_never_set", line=line, name=found[1], asked=found[2], known=near[0])
        for found in _STATE_SET.finditer(text):
            if found[2] in unasked and (near := _alike(found[2], sorted(asked))):
                return mistake("state_never_set", line=line, name=found[1], asked=found[2], known=near[0])
    return None


def _alike(name: str, others: list[str]) -> list[str]:
    """Return those of other states that look the same: but for capitals, or else a letter or two."""
    same = [one for one in others if one.lower() == name.lower()]
    return same or difflib.get_close_matches(name, others, 1, _NEAR)
