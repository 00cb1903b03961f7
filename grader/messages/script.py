"""What the text of a script shows, for the words of a hint. The text is searched, never parsed or run.

The trusted side must not give a student's text to Python's parser (deep nesting ends the process), so these are
patterns over lines from which strings and comments are blanked out.
"""

import itertools
import re
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Final, NamedTuple

_STRING_OR_COMMENT: Final = re.compile(
    r'"""(?:\\.|[^\\])*?"""|\'\'\'(?:\\.|[^\\])*?\'\'\'|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|#[^\n]*',
    re.DOTALL,
)
_INDENT: Final = re.compile(r"[ \t]*")
_BLANKS: Final = re.compile(r"(?<=[^ \t])[ \t]+")
_LONGEST_LINE: Final = 500
_LONGEST_SCRIPT: Final = 1_000
_MOST_CHARACTERS: Final = 50_000
_ASSIGNED: Final = re.compile(r"[ \t]*(?:self\.|cls\.)?(\w+) ?(?::[^=]*)?=(?!=)(.*)$")
_OTHER_BINDING: Final = re.compile(
    r"\b(?:for|as|global|nonlocal) ([\w, ]+?)(?: in\b|:|$)|\bdef \w+ ?\((.*)|"
    r"(?<![\w.])([\w.]+(?: ?, ?[\w.]+)*) ?(?:[-+*/|&^%]|//|\*\*)?=(?!=)"
)
"""Where a name gets a value other than by a plain assignment: loops, parameters, ``+=``."""
_EQUALS: Final = re.compile(r"(?<![=!<>])=(?!=)")
_TAB: Final = 8
_CLEANS_UP: Final = re.compile(
    r"(\w+\.)*(destroy_\w+|shutdown|try_shutdown|info|print|exit|join)\(|(except|finally|else|pass|return|raise)\b"
    r"|if (\w+\.)?ok\( ?\) ?:"
)
"""Statements that stand behind `rclpy.spin()` in right scripts, too, and do no work."""

_BROAD: Final = re.compile(r"\bexcept ?:|\b((Base)?Exception|AssertionError|TypeError)\b")
"""An ``except`` that catches what a wrong value in a message raises."""

_MOST_CALLS: Final = 12

NOT_ZERO: Final = r"=(?!=)(?! ?-?[0.]+ ?(?:[;\n]|$))"
"""Behind a name: an assignment of anything but a plain 0."""

LONGEST_NAME: Final = 60
"""Of the names that are compared for being alike, which takes the square of their lengths."""


class Definition(NamedTuple):
    """A ``def``: its line and indentation, and whether its first parameter is ``self``."""

    line: int
    indent: int
    takes_self: bool


class Callback(NamedTuple):
    """A function that a timer, subscription or service calls.

    `created` is the line that creates the timer, `begins` the line of the function's ``def``.
    """

    created: int
    name: str
    begins: int


class Mention(NamedTuple):
    """A line on which the name of a function stands alone, and the name as it is written there: ``self.stop``."""

    line: int
    name: str


class Assigned(NamedTuple):
    """The only assignment of a name, with or without ``self.``: its line, and the expression on its right."""

    line: int
    name: str
    value: str


_TERMINAL = re.compile(
    r"Traceback \(most recent call last\):|\[(INFO|WARN|ERROR|FATAL|DEBUG)\] \[\d+\.\d+\] \[|>>> |"
    r"[\w.-]+@[\w.-]+:\S*[$#] |PS [A-Z]:\\\S*> |\$ (ros2|python3?|colcon|cd|source)\b|  File \".+\", line \d+, in "
)


class ScriptText:
    """The code of a script, line by line, without strings and comments.

    A script that is longer than what beginners write has no lines here: searching it would take minutes. Line
    numbers come from the script's own account of itself, so any number may be asked for.
    """

    def __init__(self, source: str) -> None:
        self._source = source
        self._called: dict[str, bool] = {}
        self._blocks: dict[int, list[str]] = {}
        self._runs: dict[int, set[int]] = {}

    @cached_property
    def lines(self) -> list[str]:
        """The lines; strings are ``""``, comments nothing, blanks behind the indentation single.

        Patterns try blanks in several ways, and a hostile line of blanks would take them a minute.
        """
        if not self.is_short:
            return []
        code = _STRING_OR_COMMENT.sub(_blank, self._source.replace("\r\n", "\n"))
        return [_BLANKS.sub(" ", line)[:_LONGEST_LINE] for line in code.split("\n")]

    @property
    def is_short(self) -> bool:
        """Whether it is as short as what beginners write; only then is it searched."""
        return self._source.count("\n") < _LONGEST_SCRIPT and len(self._source) <= _MOST_CHARACTERS

    @cached_property
    def terminal_line(self) -> int | None:
        """The first line that a terminal has printed, and nobody writes: a prompt, a log, a traceback."""
        lines = self._source.split("\n", _LONGEST_SCRIPT)[:_LONGEST_SCRIPT]
        printed = (number for number, line in enumerate(lines, 1) if _TERMINAL.match(line[:_LONGEST_LINE]))
        return next(printed, None)

    @property
    def has_code(self) -> bool:
        """Whether there is more than comments and strings."""
        return not self.is_short or any(line.strip().strip("\"'") for line in self.lines)

    def lines_with(self, pattern: str) -> list[int]:
        """Return the numbers of the lines in which `pattern` is found."""
        found = re.compile(pattern)
        return [number for number, line in enumerate(self.lines, start=1) if found.search(line)]

    def matches(self, pattern: str) -> Iterator[tuple[int, re.Match[str]]]:
        """Yield each place in a line at which `pattern` is found, with the line's number."""
        found = re.compile(pattern)
        for number, line in enumerate(self.lines, start=1):
            for match in found.finditer(line):
                yield number, match

    def definition(self, name: str) -> Definition | None:
        """Return the only ``def`` of that name; None when there is none, or more than one."""
        return self._definitions.get(name)

    @cached_property
    def _definitions(self) -> dict[str, Definition | None]:
        found: dict[str, Definition | None] = {}
        for number, made in self.matches(r"^[ \t]*def[ \t]+(\w+)[ \t]*\([ \t]*(self\b)?"):
            known = made[1] in found
            found[made[1]] = None if known else Definition(number, _indent(made.string), made[2] is not None)
        return found

    def asks_for_more(self, number: int) -> bool:
        """Whether the ``def`` on a line has parameters that must be given, besides ``self``."""
        inside = self.lines[number - 1].partition("(")[2].rpartition(")")[0] if number else ""
        parts = [part.strip() for part in inside.split(",") if part.strip()]
        return any(not re.match(r"(self$|\*)", part) and "=" not in part for part in parts)

    def is_decorated(self, number: int) -> bool:
        """Whether a decorator stands above the given line, such as ``@staticmethod``."""
        return 1 < number <= len(self.lines) and self.lines[number - 2].lstrip().startswith("@")

    def assigned(self, name: str) -> Assigned | None:
        """Return the only assignment of that name; None when there is none, or more than one."""
        return self._assigned.get(name)

    def argument_for(self, name: str) -> str | None:
        """Return the argument that every call gives for the parameter `name`.

        None if calls give different ones, if several functions have a parameter of that name, or if the name is
        assigned anywhere.
        """
        made = self._parameters.get(name)
        if made is None or self.lines_with(rf"(?<![\w.]){re.escape(name)} ?([-+*/]|//)?=(?!=)"):
            return None
        function, place = made
        calls = self.lines_with(rf"(?<!def )(?<!\w){re.escape(function)}\(")
        given = {tuple(self.arguments(number, function)[place : place + 1]) for number in calls[:_MOST_CALLS]}
        only = given.pop() if len(given) == 1 else ()
        return only[0] if only and len(calls) <= _MOST_CALLS else None

    @cached_property
    def _parameters(self) -> dict[str, tuple[str, int] | None]:
        """The parameters of all functions: function and place among its arguments; None for several of a name."""
        found: dict[str, tuple[str, int] | None] = {}
        for _, made in self.matches(r"^[ \t]*def (\w+) ?\( ?(?:self ?,? ?)?([^()]*)\)"):
            for place, part in enumerate(made[2].split(",")):
                name = part.partition("=")[0].partition(":")[0].strip()
                found[name] = None if name in found else (made[1], place)
        return found

    @cached_property
    def known_values(self) -> dict[str, float | None]:
        """Values of assigned names that `grader.messages.arithmetic` has found, which keeps them here."""
        return {}

    @cached_property
    def _assigned(self) -> dict[str, Assigned | None]:
        found: dict[str, Assigned | None] = {}
        for number, line in enumerate(self.lines, start=1):
            whole = _ASSIGNED.match(line)
            if whole is not None:
                known = whole[1] in found
                found[whole[1]] = None if known else Assigned(number, whole[1], whole[2].strip())
                continue
            for names in _OTHER_BINDING.findall(line):
                found.update(dict.fromkeys(re.findall(r"\w+", " ".join(names))))
        return found

    def body(self, number: int) -> list[tuple[int, str]]:
        """Return the statements directly in the block that the given line begins, with their numbers."""
        inside = [
            (number + i, line) for i, line in enumerate(self.block(number)[1:], start=1) if line.strip()
        ]
        first = _indent(inside[0][1]) if inside else 0
        return [(at, line.strip()) for at, line in inside if _indent(line) == first]

    def callbacks(self, *kinds: str) -> list[Callback]:
        """Return the callbacks of timers, subscriptions or services: those of the first kind, then of the next."""
        return [
            callback
            for kind in kinds
            for number in self.lines_with(rf"\bcreate_{kind}\(")
            if (callback := self._callback(kind, number)) is not None
        ]

    def functions_called_back(self, *kinds: str) -> list[Callback]:
        """Return `callbacks`, each function once: a hostile script may create a timer on every line."""
        found: dict[str, Callback] = {}
        for callback in self.callbacks(*kinds):
            found.setdefault(callback.name, callback)
        return list(found.values())

    def _callback(self, kind: str, number: int) -> Callback | None:
        """Return the first function of the script that is named in a call of ``create_<kind>``."""
        call = " ".join(self.lines[number - 1 : number + 5]).partition(f"create_{kind}(")[2]
        for pair in re.findall(r"(?:self|node|\w+)\.(\w+)|(\w+)", _arguments(call)):
            for name in filter(None, pair):
                if (made := self.definition(name)) is not None:
                    return Callback(number, name, made.line)
        return None

    def in_method(self, number: int) -> bool:
        """Whether the given line stands in a function whose first parameter is ``self``."""
        heads = (head for _, head in self.outwards(number) if re.match(r"[ \t]*def\b", head))
        return re.search(r"\([ \t]*self\b", next(heads, "")) is not None

    def node_name_at(self, number: int) -> str:
        """Return the name of the node on a line: ``self`` in a method, else the variable that holds the node."""
        if any(re.match(r"[ \t]*def \w+ ?\( ?self\b", head) for _, head in self.outwards(number)):
            return "self"
        made = rf"^[ \t]*(\w+) ?= ?(?:{self.node_class}|(?:rclpy\.)?create_node|Node)\("
        return next((found[1] for _, found in self.matches(made)), "node")

    def calls_its_callback(self, number: int, name: str) -> bool:
        """Whether the given line calls `name` where a callback is wanted: ``create_timer(0.1, self.tick())``."""
        call = " ".join(self.lines[max(number - 5, 0) : number])
        wanting = list(re.finditer(r"\bcreate_(timer|subscription|service)\(", call))
        given = re.compile(rf"\b{re.escape(name)}\([ \t]*\)")
        return bool(wanting) and given.search(_arguments(call[wanting[-1].end() :])) is not None

    def arguments(self, number: int, name: str) -> list[str]:
        """Return the arguments of the call of `name` that begins on the given line, as `lines` has them."""
        call = " ".join(self.lines[max(number - 1, 0) : number + 6]).partition(f"{name}(")[2]
        return [part.strip() for part in _arguments(call).split(",") if part.strip()]

    def written(self, number: int) -> str:
        """Return the given line as it was written, with its strings and comments."""
        return self._written[number - 1][:_LONGEST_LINE] if 0 < number <= len(self._written) else ""

    @cached_property
    def _written(self) -> list[str]:
        return self._source.replace("\r\n", "\n").split("\n")

    @property
    def quoted_numbers(self) -> list[int]:
        """The lines that declare a parameter whose default is a number in quotes."""
        default = re.compile(r"declare_parameter\( ?(\"[^\"]*\"|'[^']*') ?, ?[\"'] ?-?\d*\.?\d+ ?[\"']")
        declared = self.lines_with(r'\bdeclare_parameter\( ?"" ?, ?""')
        return [number for number in declared if default.search(_BLANKS.sub(" ", self.written(number)))]

    def calls(self, name: str) -> bool:
        """Whether the script calls a function of this name, or passes it on, as to ``create_timer``."""
        known = self._called.get(name)
        if known is None:
            known = self._called[name] = bool(self.lines_with(rf"(?<!\bdef )(?<!\w){re.escape(name)}\b"))
        return known

    @property
    def defined_twice(self) -> tuple[str, int, int] | None:
        """A function or method that is written twice, where both begin: the second replaces the first."""
        seen: dict[tuple[int | None, str], int] = {}
        for number, made in self.matches(r"^[ \t]*def (\w+) ?\("):
            key = (self.owner_of(number), name := made[1])
            if key in seen and not any("@" in line for line in self.lines[number - 2 : number - 1]):
                return name, seen[key], number
            seen[key] = number
        return None

    def methods(self, names: Sequence[str]) -> list[str]:
        """Return those of `names` that the script gives to methods of its own."""
        return [name for name in names if (made := self.definition(name)) is not None and made.takes_self]

    def class_line(self, name: str) -> int | None:
        """Return the line on which the class begins."""
        return next(iter(self.lines_with(rf"^[ \t]*class[ \t]+{re.escape(name)}\b")), None)

    def class_without_base(self, name: str) -> bool:
        """Whether the class is written without a base class."""
        head = rf"^[ \t]*class[ \t]+{re.escape(name)}[ \t]*(\([ \t]*(object)?[ \t]*\))?[ \t]*:"
        return bool(self.lines_with(head))

    def owner_of(self, number: int) -> int | None:
        """Return the line that begins the block in which the given line stands; None at the top level."""
        return self._owners[number - 1] if 0 < number <= len(self.lines) else None

    def outwards(self, number: int) -> Iterator[tuple[int, str]]:
        """Yield the given line and those that begin the blocks around it, the innermost first, with their text."""
        above = number if 0 < number <= len(self.lines) else None
        while above is not None:
            yield above, self.lines[above - 1]
            above = self._owners[above - 1]

    @cached_property
    def _owners(self) -> list[int | None]:
        owners: list[int | None] = []
        begun: list[int] = []  # the blocks around the line, and how far in each begins
        indents: list[int] = []
        for number, line in enumerate(self.lines, start=1):
            depth = bisect_left(indents, _indent(line))
            owners.append(begun[depth - 1] if depth else None)
            if line.strip():
                begun[depth:], indents[depth:] = [number], [_indent(line)]
        return owners

    @property
    def defined_names(self) -> list[str]:
        """The names of the functions and classes that stand at the top level, in order; none that is very long."""
        found = (re.match(rf"(?:def|class) (\w{{1,{LONGEST_NAME}}})\b", line) for line in self.lines)
        return [one[1] for one in found if one is not None]

    def is_behind(self, number: int, first: int) -> bool:
        """Whether a line may run after the line `first` above it, that is, not in another branch of its ``if``."""
        others = dict(self.heads_around(number)).keys() - dict(self.outwards(number)).keys()
        return others.isdisjoint(dict(self.outwards(first)))

    def conditions_around(self, number: int) -> list[str]:
        """Return the heads of the blocks around a line in its function; with an ``else`` also its ``if``."""
        return [head for _, head in self.heads_around(number)]

    def heads_around(self, number: int) -> Iterator[tuple[int, str]]:
        """Yield the heads that `conditions_around` returns, each with its line number."""
        for at, head in itertools.islice(self.outwards(number), 1, None):
            if re.match(r"[ \t]*(def|class)\b", head):
                return
            yield at, head
            last = head
            for above in range(at - 1, 0, -1):
                line = self.lines[above - 1]
                if not re.match(r"[ \t]*(elif|else)\b", last) or (
                    line.strip() and _indent(line) < _indent(head)
                ):
                    break
                if line.strip() and _indent(line) == _indent(head):
                    yield above, line
                    last = line

    @property
    def counters(self) -> set[str]:
        """The names that are raised by 1 somewhere."""
        return {
            found[1] for _, found in self.matches(r"(?<![\w.])([\w.]+) ?(?:\+= ?1|= ?\1 ?\+ ?1)(?![\w.])")
        }

    def reached_from(self, numbers: Iterable[int]) -> set[int]:
        """Return the first lines of the blocks that begin at `numbers`, and of the functions that run from there.

        These are the functions of the script that a block calls, those that they call, and so on. A call is known
        by the function's name alone, whatever stands before it: ``self.turn()``, ``node.turn()``.
        """
        found = set(numbers)
        left = sorted(found)
        while left:
            new = self._run_from(left.pop()) - found
            found |= new
            left += sorted(new)
        return found

    def _run_from(self, number: int) -> set[int]:
        """Return the first lines of the functions that a block calls."""
        if number not in self._runs:
            names = set(re.findall(r"(\w+)\(", "\n".join(self.block(number))))
            found = {made.line for name in names if (made := self.definition(name)) is not None}
            self._runs[number] = found
        return self._runs[number]

    def spins(self, number: int) -> bool:
        """Whether the block that begins on a line spins, itself or in a function that it calls."""
        return any("spin" in line for begins in self.reached_from([number]) for line in self.block(begins))

    def works_after(self, number: int) -> bool:
        """Whether code behind the given line, in the same block or one around it, does work."""
        if not 0 < number <= len(self.lines):
            return False
        indent = _indent(self.lines[number - 1])
        for line in self.lines[number:]:
            if not line.strip():
                continue
            if _indent(line) > indent:
                continue  # inside a block, whose head was looked at, or the rest of a call
            if re.match(r"[ \t]*(def|class|if __name__)\b", line):
                if self.function_around(number) or line.startswith("if"):
                    return False
                continue
            indent = _indent(line)
            if line.strip() == f"{self.function_around(number)}()":
                continue
            if not _CLEANS_UP.match(line.strip()) and re.search(r"\w\(|^\s*(for|while)\b", line):
                return True
        return False

    def function_around(self, number: int) -> str:
        """Return the name of the function in which the given line stands; nothing at the top level."""
        around = itertools.islice(self.outwards(number), 1, None)
        names = (found[1] for _, head in around if (found := re.match(r"[ \t]*def (\w+)", head)))
        return next(names, "")

    @property
    def named_only(self) -> Mention | None:
        """The first line that only names a function, of the script or of ROS, without the brackets of a call."""
        for number in self.lines_with(r"^[ \t]*(\w+\.)*\w+$"):
            written = self.lines[number - 1].strip()
            before, behind = (
                "".join(self.lines[part]).strip()
                for part in (slice(max(number - 2, 0), number - 1), slice(number, number + 1))
            )
            made = self.definition(written.rpartition(".")[2])
            known = made is not None or re.search(r"\w\.(publish|start|sleep|spin_once)$", written)
            if known and before[-1:] not in {",", "("} and behind[:1] != ")":
                return Mention(number, written)
        return None

    @property
    def silent_except(self) -> int | None:
        """The line of the first ``except`` that hides an error: it neither tells of it nor raises it."""
        return self._hiding(r"pass$|continue$")

    @property
    def lenient_except(self) -> int | None:
        """The line of the first ``except`` that hides an error, or only prints or logs it."""
        return self._hiding(r"pass$|continue$|print\(|.*\bget_logger\(\)\.\w+\(")

    def _hiding(self, body: str) -> int | None:
        """Return the line of the first ``except`` for any error whose first statement matches `body`."""
        for number in self.lines_with(r"^[ \t]*except\b[^:]*:"):
            rest = self.lines[number - 1].partition(":")[2].strip()
            behind = rest or "".join(self.lines[number : number + 1]).strip()
            hides = re.match(body, behind) and _BROAD.search(self.lines[number - 1])
            if hides and not self._only_cleans_up(number):
                return number
        return None

    def _only_cleans_up(self, number: int) -> bool:
        """Whether the ``try`` of an ``except`` holds nothing but the calls that end a program."""
        indent = _indent(self.lines[number - 1])
        above = range(number - 1, 0, -1)
        tried = next((at for at in above if re.match(rf"[ \t]{{{indent}}}try ?:", self.lines[at - 1])), None)
        body = self.body(tried) if tried is not None else []
        return bool(body) and all(re.search(r"\b(\w*shutdown|destroy_\w+|close)\(", text) for _, text in body)

    def twist_name_at(self, number: int) -> str | None:
        """Return the variable to which the function around a line assigned its only Twist, above that line."""
        around = self.function_around(number)
        twists = self.matches(r"^[ \t]*([\w.]+) ?= ?Twist\(")
        made = {found[1] for at, found in twists if at <= number and self.function_around(at) == around}
        return made.pop() if len(made) == 1 else None

    def attributes_set_in(self, name: str) -> set[str]:
        """Return the attributes of ``self`` that the function `name` assigns."""
        made = self.definition(name)
        body = "\n".join(self.block(made.line)) if made is not None else ""
        return set(re.findall(r"\bself\.(\w+) ?(?::[^=\n]*)?=(?!=)", body))

    @cached_property
    def attributes_set(self) -> Mapping[str, list[tuple[int, str]]]:
        """The attributes that are assigned, of any object: on which lines, and the text behind the last ``=``.

        Attributes on the left of any other ``=``, such as that of a keyword, are taken for assigned as well.
        """
        found: dict[str, list[tuple[int, str]]] = {}
        for number, line in enumerate(self.lines, start=1):
            *targets, value = _EQUALS.split(line)
            for name in dict.fromkeys(re.findall(r"\w\.(\w+)\b", " ".join(targets))):
                found.setdefault(name, []).append((number, value.strip()))
        return found

    def span(self, number: int) -> range:
        """Return the numbers of the lines of `block`."""
        return range(number, number + len(self.block(number)))

    def block(self, number: int) -> list[str]:
        """Return the given line and the block that it begins."""
        if not 0 < number <= len(self.lines):
            return []
        if number not in self._blocks:
            lines, indent = self.lines[number - 1 :], _indent(self.lines[number - 1])
            deeper = itertools.takewhile(lambda line: not line.strip() or _indent(line) > indent, lines[1:])
            self._blocks[number] = [*lines[:1], *deeper]
        return self._blocks[number]

    @property
    def node_class(self) -> str | None:
        """The name of the first class that is made from Node."""
        found = re.search(
            r"^[ \t]*class[ \t]+(\w+)[ \t]*\([^)\n]*Node\b", "\n".join(self.lines), re.MULTILINE
        )
        return found[1] if found else None

    @cached_property
    def publisher(self) -> str | None:
        """The name under which the script keeps its only publisher of Twist; None when that is not clear."""
        text = "\n".join(self.lines)
        pattern = (
            r"^[ \t]*((?:self\.)?\w+)[ \t]*(?::[^=\n]*)?=[ \t]*[\w.]*\bcreate_publisher\(\s*[\w.]*Twist\b"
        )
        names = set(re.findall(pattern, text, re.MULTILINE))
        return names.pop() if len(names) == 1 else None

    @property
    def publisher_name(self) -> str:
        """What a hint calls the publisher: the name that the script gives it, else ``publisher``."""
        return self.publisher or "publisher"


def _arguments(text: str) -> str:
    """Return `text` up to the bracket that closes what was open before it."""
    open_brackets = 1
    for end, character in enumerate(text):
        open_brackets += (character in "([{") - (character in ")]}")
        if not open_brackets:
            return text[:end]
    return text


def _indent(line: str) -> int:
    found = _INDENT.match(line)
    return len(found[0].expandtabs(_TAB)) if found else 0


def _blank(found: re.Match[str]) -> str:
    """Return what stands for a string or a comment: as many lines, no words."""
    text = found[0]
    return "" if text.startswith("#") else '""' + "\n" * text.count("\n")


NO_SCRIPT: Final = ScriptText("")
