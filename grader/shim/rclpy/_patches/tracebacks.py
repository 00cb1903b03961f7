"""Exceptions in the student's own terms: frames of the student's file only, causes kept."""

from __future__ import annotations

import sys

from rclpy._kernel import Kernel, Thread, kernel
from rclpy._link import link

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from types import FrameType, TracebackType
    from typing import Any


_print_by_python = sys.__excepthook__
"""Python's own printer: only it adds a suggestion. Taken before ours replaces it in `sys`."""

_LONGEST_MESSAGE = 1 << 16
"""Characters of a message that is sent or quoted: more than any place has room for. Printed ones are not cut."""

_LONGEST_NOTE = 1_000
_OF_TEXT = (AssertionError, AttributeError, NameError, TypeError, UnboundLocalError)

_BARE_MODULES = ("builtins", "__main__")
"""Modules whose exceptions are named without the module."""


class Script:
    """The script that runs: its name, and its lines for `linecache`.

    Attributes:
        files: of a package all modules, by the names that tracebacks show; else nothing.
        aborted: what ends it where code in C would abort the process; never raised.
        told_caught: whether an error that was caught has been told.
        meant: lines whose errors the script may count on: they are not told.
    """

    def __init__(self) -> None:
        self.file_name = ""
        self.source = b""
        self.files: dict[str, bytes] = {}
        self.aborted: BaseException | None = None
        self.told_caught = False
        self.meant: set[int] = set()

    def owns(self, file_name: str | None) -> bool:
        """Whether code of this file is the student's."""
        return file_name == self.file_name or file_name in self.files

    def lines(self, file_name: str | None = None) -> list[str]:
        """Return a file's lines (the script's own), decoded as Python does; empty when they cannot be decoded."""
        import tokenize
        from io import BytesIO, TextIOWrapper

        source = self.source if file_name is None else self.files.get(file_name, self.source)
        try:
            encoding, _ = tokenize.detect_encoding(BytesIO(source).readline)
            text = TextIOWrapper(BytesIO(source), encoding).read()
        except (SyntaxError, UnicodeError, LookupError):
            return []
        lines = text.splitlines(keepends=True)
        if lines and not lines[-1].endswith("\n"):
            lines[-1] += "\n"
        return lines


script = Script()


def prime_linecache(linecache: Any) -> None:
    """Make tracebacks and `inspect` find the source, which is in no file."""
    entry = (len(script.source), None, script.lines(), script.file_name)
    linecache.cache[script.file_name] = entry
    for name, source in script.files.items():
        linecache.cache[name] = (len(source), None, script.lines(name), name)


def patch_traceback(traceback: Any) -> None:
    """Make tracebacks that a script prints or logs show only its own frames: others differ between hosts."""
    summary = traceback.StackSummary
    name = "_extract_from_extended_frame_gen"
    if not hasattr(summary, name):  # Python 3.10 has no places within a line to extract
        name = "extract"
    extract = getattr(summary, name).__func__

    def extract_own(kind: Any, /, frames: Iterable[tuple[FrameType, Any]], **options: Any) -> Any:
        own = ((frame, place) for frame, place in frames if script.owns(frame.f_code.co_filename))
        return extract(kind, own, **options)

    setattr(summary, name, classmethod(extract_own))


def line_of(error: BaseException) -> int:
    """Return the line of the innermost frame of the student's file; 0 when there is none."""
    if isinstance(error, SyntaxError) and script.owns(error.filename):
        return error.lineno or 0
    line = 0
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        if script.owns(traceback.tb_frame.f_code.co_filename):
            line = traceback.tb_lineno or 0
        traceback = traceback.tb_next
    return line


def tell_caught(error: BaseException | None, *, now: bool = True) -> None:
    """Note, once, an error of the script's own text that does not end it, because something has caught it.

    Of other errors, of what the script raises itself, of what is not there yet, and of the clean-up after Ctrl+C
    nothing is told: they may be meant to be caught. `now` says that it has just happened.
    """
    if script.told_caught or error is None or type(error) not in _OF_TEXT or (now and kernel.interrupted):
        return  # at once: a loop may come here a million times
    line = line_of(error)
    if line == 0 or line in script.meant:
        return
    if _is_raised(error) or _is_awaited(error):
        script.meant.add(line)
    else:
        script.told_caught = True
        link.note("caught", f"line {line}: {one_line(error)[:_LONGEST_NOTE]}{_suggestion(error)}")


def _is_awaited(error: BaseException) -> bool:
    """Whether an error may be of what comes with the first message.

    Such is None, an attribute that some line gives a value, or a name that a function does as ``global``.
    """
    if "'NoneType'" in message_of(error):
        return True
    name = getattr(error, "name", None)
    if type(name) is not str:
        return False
    sources = [script.lines(), *map(script.lines, script.files)]
    return any(_gives(name, text, type(error)) for lines in sources for text in lines)


def _gives(name: str, text: str, kind: type[BaseException]) -> bool:
    """Whether a line makes a name ``global``, or gives an attribute of that name a value."""
    if kind is not AttributeError:
        return text.split()[:1] == ["global"] and name in text.replace(",", " ").split()
    before, sign, value = text.partition("=")
    _, dot, behind = before.rpartition(f".{name}")
    return bool(sign and dot) and value[:1] != "=" and behind.strip()[:1] in ("", ",", ":")


def _is_raised(error: BaseException) -> bool:
    """Whether the error comes from a statement ``raise`` or ``assert`` of the script's own."""
    from opcode import opmap

    innermost: TracebackType | None = error.__traceback__
    while innermost is not None and innermost.tb_next is not None:
        innermost = innermost.tb_next
    if innermost is None:
        return False
    code = innermost.tb_frame.f_code
    return script.owns(code.co_filename) and code.co_code[innermost.tb_lasti] == opmap["RAISE_VARARGS"]


def message_of(error: BaseException) -> str:
    """Return the beginning of `str(error)`, whatever the class does."""
    try:
        text = error.msg if isinstance(error, SyntaxError) else str(error)
        return "".join((text,))[:_LONGEST_MESSAGE]  # joined: of a class derived from str nothing is called
    except Exception:
        return "<exception str() failed>"


def one_line(error: BaseException) -> str:
    """Return ``Type: message``."""
    message = message_of(error)
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


def format_exception(error: BaseException) -> str:
    """Return the traceback as Python prints it, with the student's frames only."""
    try:
        import traceback

        exception = traceback.TracebackException(type(error), error, error.__traceback__, compact=True)
        _add_texts(exception)
        text = "".join(exception.format())
        if not isinstance(error, (NameError, AttributeError)):
            return text
        bare, suggestion = text.removesuffix("\n"), _suggestion(error)
        return f"{bare.removesuffix(suggestion)}{suggestion}\n"  # from Python 3.12 on it is there already
    except Exception:
        return f"{one_line(error)}\n"


def _suggestion(error: BaseException) -> str:
    """Return what Python prints behind the message, such as ``. Did you mean: 'Twist'?``; often nothing.

    Up to Python 3.11 only the interpreter's own printer makes suggestions; it prints into memory, without frames.
    """
    from io import StringIO

    printed, stderr = StringIO(), sys.stderr
    limit = getattr(sys, "tracebacklimit", None)
    sys.stderr, sys.tracebacklimit = printed, 0
    try:
        _print_by_python(type(error), error, error.__traceback__)
    finally:
        sys.stderr = stderr
        if limit is None:
            del sys.tracebacklimit
        else:
            sys.tracebacklimit = limit
    _, mark, name = printed.getvalue().rpartition(". Did you mean: ")
    return mark + name.rstrip("\n") if mark and mark not in message_of(error) else ""


def _add_texts(exception: Any) -> None:
    """Give each SyntaxError of the compiler in the chain its line, which Python looks up in the file."""
    ids: set[int] = set()
    waiting = [exception]
    while waiting:
        one = waiting.pop()
        if one is None or id(one) in ids:
            continue
        ids.add(id(one))
        name = getattr(one, "filename", None)
        if script.owns(name) and not getattr(one, "text", None):
            lines = script.lines(name)
            number = int(one.lineno or 0)
            one.text = lines[number - 1] if 0 < number <= len(lines) else one.text
        waiting += [one.__cause__, one.__context__, *(getattr(one, "exceptions", None) or ())]


def print_exception(error: BaseException) -> None:
    """Print the traceback to stderr."""
    try:
        sys.stderr.write(format_exception(error))
        sys.stderr.flush()
    except (OSError, ValueError, AttributeError):
        pass  # the script has closed or replaced its stderr


def excepthook(_: type[BaseException], error: BaseException, __: TracebackType | None) -> None:
    """`sys.excepthook`: what Python prints, without our frames."""
    print_exception(error)


def unraisablehook(args: Any, /) -> None:
    """`sys.unraisablehook`: what Python prints of errors in `__del__` and in exit functions, without our frames.

    It raises nothing: Python would print where in this file that happened.
    """
    try:
        sys.stderr.write(_format_unraisable(args))
        sys.stderr.flush()
    except BaseException:  # noqa: S110 - also of a stderr of the script's own
        pass


def _format_unraisable(args: Any) -> str:
    """Return what `write_unraisable_exc_file` of CPython 3.11's Python/errors.c writes."""
    text = ""
    if args.object is not None:
        text = f"{args.err_msg or 'Exception ignored in'}: {_repr_of(args.object)}\n"
    elif args.err_msg:
        text = f"{args.err_msg}:\n"
    if args.exc_traceback is not None:
        text += _format_frames(args)
    module = args.exc_type.__module__
    text += (
        args.exc_type.__qualname__ if module in _BARE_MODULES else f"{module}.{args.exc_type.__qualname__}"
    )
    return text + ("\n" if args.exc_value is None else f": {_str_of(args.exc_value)}\n")


def _format_frames(args: Any) -> str:
    """Return the student's frames under their heading; empty where Python on a PC would have no frame either."""
    import traceback

    if not _is_at_home(args.exc_traceback):
        return ""

    frames = traceback.format_tb(args.exc_traceback)
    if sys.meta_path is None:  # at the end of Python, which finds no source any more
        frames = [frame.partition("\n")[0] + "\n" for frame in frames]
    return "".join(["Traceback (most recent call last):\n", *frames])


def _is_at_home(traceback: TracebackType | None) -> bool:
    """Whether a frame is of code that is there on a PC as well: the script's, Python's or upstream's."""
    own = ("/rclpy/_process/", "/rclpy/_patches/", "/rclpy/_kernel.py")
    while traceback is not None:
        if not any(part in traceback.tb_frame.f_code.co_filename for part in own):
            return True
        traceback = traceback.tb_next
    return False


def _repr_of(value: object) -> str:
    try:
        return repr(value)
    except Exception:
        return "<object repr() failed>"


def _str_of(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:
        return "<exception str() failed>"


def explain_stall(kernel: Kernel) -> str:
    """Return one sentence per blocked thread: who waits in which line for what."""
    frames = sys._current_frames()
    return "; ".join(_explain(thread, frames.get(thread.os_ident)) for thread in kernel.threads)


def main_thread_at(kernel: Kernel) -> str:
    """Return where the main thread is: line, the call made there (or ``-``), and when that ends, in ns."""
    call, frame = _call(sys._current_frames().get(kernel.main.os_ident))
    line = 0 if frame is None else frame.f_lineno
    return f"{line} {call or '-'} {kernel.main.deadline_ns}"


def line_of_call(file_name: str, functions: Collection[str]) -> int:
    """Return the line of the script that has called `functions` of a file; 0 if other code of that file has."""
    frame: FrameType | None = sys._getframe()
    while frame is not None:
        code = frame.f_code
        if script.owns(code.co_filename):
            return frame.f_lineno
        if code.co_filename == file_name and code.co_name not in functions:
            return 0
        frame = frame.f_back
    return 0


def _call(frame: FrameType | None) -> tuple[str, FrameType | None]:
    """Return what the student's innermost frame calls, and that frame."""
    call = ""
    while frame is not None and frame.f_code.co_filename != script.file_name:
        call = _qualified_name(frame)
        frame = frame.f_back
    return call, frame


def _qualified_name(frame: FrameType) -> str:
    """Return a function's name with its class; Python 3.10 only tells it of functions, not of their code."""
    code = frame.f_code
    if hasattr(code, "co_qualname"):
        return code.co_qualname
    owner = frame.f_locals.get("self")
    for base in type(owner).__mro__:
        function = vars(base).get(code.co_name)
        if function is not None and getattr(function, "__code__", None) is code:
            return str(function.__qualname__)
    return code.co_name


def _explain(thread: Thread, frame: FrameType | None) -> str:
    call, frame = _call(frame)
    place = f", line {frame.f_lineno}" if frame is not None else ""
    return f"{thread.name}{place}: {thread.why or f'{call}() waits for ever'}"
