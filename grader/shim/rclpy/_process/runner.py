"""What the confined process executes: get ready, read START, run the script, send EXIT, end.

`run` is called with nothing of the script in memory and does not return. Descriptors: 0 /dev/null, 1 and 2
pipes, and the channel.
"""

from __future__ import annotations

import builtins
import gc
import io
import os
import sys
from types import CodeType, ModuleType, SimpleNamespace

from rclpy import _distro, _wire
from rclpy._interfaces import importer  # the interface packages can be imported from now on
from rclpy._kernel import kernel
from rclpy._link import Descriptor, link
from rclpy._patches import install, output, tracebacks
from rclpy._process import loops
from rclpy._process.itself import import_itself, imports_itself
from rclpy._process.packages import workspace
from rclpy._storage.entries import WORK
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO, NoReturn

    from rclpy._process.entry_point import EntryPoint
    from rclpy._process.facts import Ledger

PIPE_BYTES = 65_536
"""Capacity of a Linux pipe; a longer stdin is served from memory."""

UNANSWERED = 1_000
"""Readings behind the end of the input that cost no time: what asks so often is a loop."""

_end_process = os._exit


class Ending:
    """How the run ended, put together step by step and sent once."""

    def __init__(self) -> None:
        self.reason = _wire.FINISHED
        self.code = 0
        self.type = ""
        self.message = ""
        self.line = 0
        self.text = ""
        self.crashed_early = False  # before Ctrl+C, though threads or other programs went on to it

    def set_error(self, error: BaseException, reason: int = _wire.RAISED) -> None:
        """Take over an exception that ended the script."""
        self.reason = reason
        self.code = 1
        self.crashed_early = not kernel.interrupted
        self.type = type(error).__name__
        self.message = tracebacks.message_of(error)
        self.line = tracebacks.line_of(error)
        self.text = tracebacks.format_exception(error)

    def send_and_exit(self) -> NoReturn:
        """Send EXIT and end the process, whatever still runs."""
        try:
            link.exit(
                _wire.Exit(
                    min(kernel.now_ns, kernel.horizon_ns),
                    self.reason,
                    kernel.interrupted and not kernel.ends_early and not self.crashed_early,
                    self.code,
                    self.type,
                    self.message,
                    self.line,
                    self.text,
                )
            )
        finally:
            _end_process(self.code & 0xFF)


ending = Ending()


def run(channel: int = 3) -> NoReturn:
    """Run the script that START brings over descriptor `channel`; what needs no START is done before it comes."""
    _get_ready()
    text, source = link.receive_start(Descriptor(channel))
    import json

    start: dict[str, Any] = json.loads(text)
    if "replay" in start:  # only where PyBullet is: nothing of a script's runs in this process
        from rclpy._pybullet import replay

        replay.run(start["replay"], link, _end_process)
    if "package" in start:
        workspace.mount(start["package"], source)
        start["file_name"], source = workspace.entry_source()
    tracebacks.script.file_name = start["file_name"]
    tracebacks.script.source = source
    _distro.choose(start.get("distro", _distro.HUMBLE))
    kernel.start_episode(start["horizon_ns"], start["epoch_ns"], start.get("steps"))
    link.connect_world(start["world"])
    importer.add(start.get("interfaces", []))
    module = _prepare(start, source)
    kernel.at_horizon = _tell_interrupt
    code = _compile(source)
    if code is not None:
        facts = _facts(start, source)
        entry = _entry_point(start, source)
        if entry is None and (name := imports_itself(start["file_name"], source)):
            import_itself(module, name, code)
        del source
        _tell_start()
        if facts is not None:
            facts.begin()
        _execute(module, code, entry)
    _finish()


def _entry_point(start: dict[str, Any], source: bytes) -> EntryPoint | None:
    """Return how the script is started if START asks for more than ``python3 student.py``."""
    if start.get("runs_as") != "ros2_run":
        return None
    from rclpy._process.entry_point import EntryPoint

    return EntryPoint(start["file_name"], source)


def _facts(start: dict[str, Any], source: bytes) -> Ledger | None:
    """Send the script's syntax tree if the episode asks for facts, and return what takes down the rest."""
    if not start.get("facts"):
        return None
    from rclpy._process import facts  # few runs are traced

    facts.send_tree(source, start["file_name"])
    return facts.ledger


def _tell_start() -> None:
    """Tell the episode that the script compiles, before any of its code runs.

    Once this frame is sent, the script cannot claim a syntax error any more.
    """
    link.note("started", "")
    link.flush()


def _tell_interrupt() -> None:
    """Tell the episode at once where Ctrl+C came; from now on the script has only its grace of CPU time."""
    link.note("interrupted", tracebacks.main_thread_at(kernel))
    link.flush()


def _get_ready() -> None:
    """Make the process look as Python makes it for any script."""
    install.install()
    kernel.end = end_now
    setattr(os, "_exit", exit_now)  # noqa: B010 - mypy compares the names of parameters
    sys.dont_write_bytecode = True
    sys.excepthook = sys.__excepthook__ = tracebacks.excepthook
    sys.unraisablehook = tracebacks.unraisablehook
    setattr(sys, "__unraisablehook__", tracebacks.unraisablehook)  # noqa: B010 - unknown to mypy as a variable
    output.open_streams()
    _add_site_builtins()
    setattr(builtins, loops.CHECKPOINT, kernel.checkpoint)
    setattr(builtins, loops.CAUGHT, lambda: tracebacks.tell_caught(sys.exc_info()[1]))


def _prepare(start: dict[str, Any], source: bytes) -> ModuleType:
    """Make the process look as Python makes it for ``python3 student.py``."""
    install.begin(start["seed"])
    called = workspace.argv0() if "package" in start else start["file_name"]
    if "package" not in start:
        storage.place_script(start["file_name"], source)
    sys.argv = [called, *start["args"]]
    sys.orig_argv = [sys.executable, *sys.argv]
    sys.path.insert(0, WORK if "package" not in start else called.rpartition("/")[0])
    _open_stdin(start["stdin"])
    output.budget.limit(start.get("output_bytes"), _end_at_output_limit)
    module = ModuleType("__main__")
    names: dict[str, Any] = {"__file__": called, "__builtins__": builtins, "__cached__": None}
    module.__dict__.update(names)
    sys.modules["__main__"] = module
    from rclpy._patches.audit import watch

    watch()
    return module


class _Input(io.TextIOWrapper):
    """The script's input, which ends where a terminal would wait for somebody.

    A loop that asks on and on would spend no virtual time, and only the limit on CPU time would end it. So each
    further reading takes time, up to the horizon's Ctrl+C.
    """

    def __init__(self, content: BinaryIO) -> None:
        super().__init__(content, encoding="utf-8")
        setattr(self, "mode", "r")  # noqa: B010 - declared read-only
        self._unanswered = 0

    def readline(self, size: int = -1, /) -> str:  # type: ignore[override]
        line = super().readline(size)
        return line or self._at_end()

    def read(self, size: int | None = -1, /) -> str:
        text = super().read(size)
        return text or self._at_end()

    def _at_end(self) -> str:
        self._unanswered += 1
        if self._unanswered > UNANSWERED:
            kernel.charge()
            if kernel.streak > UNANSWERED and len(kernel.threads) == 1:
                link.note_once("asks_again")
        return ""


def _open_stdin(stdin: str) -> None:
    """Give the script its input."""
    data = stdin.encode()
    if data and len(data) <= PIPE_BYTES:
        reading, writing = os.pipe()
        os.write(writing, data)
        os.close(writing)
        os.dup2(reading, 0)
        os.close(reading)
    content = io.BytesIO(data) if len(data) > PIPE_BYTES else open(0, "rb", closefd=False)  # noqa: SIM115
    sys.stdin = stream = _Input(content)
    setattr(sys, "__stdin__", stream)  # noqa: B010 - declared final


def _add_site_builtins() -> None:
    """Add `exit`, `quit` and `help`, which the module `site` provides on a PC."""
    import _sitebuiltins

    end_of_file = "Ctrl-D (i.e. EOF)"
    for name in ("quit", "exit"):
        setattr(builtins, name, _sitebuiltins.Quitter(name, end_of_file))
    setattr(builtins, "help", _sitebuiltins._Helper())  # noqa: B010 - mypy knows help as a function


def _compile(source: bytes) -> CodeType | None:
    """Compile the script; None, with the error as the run's ending, when it is not Python."""
    try:
        return loops.compile_script(source, tracebacks.script.file_name)
    except BaseException as error:
        ending.set_error(error, _wire.BAD_SYNTAX)
        tracebacks.print_exception(error)
        return None


def _execute(module: ModuleType, code: CodeType, entry: EntryPoint | None) -> None:
    """Run the script up to the end of its main thread, with its other threads and exit handlers."""
    gc.collect()  # from here on the collector runs at the same points in each run
    if tracebacks.script.files:
        _guard(_launch if workspace.launch else workspace.call)
    elif entry is not None:
        module = entry.module
        _guard(lambda: entry.call(code))
    else:
        _guard(lambda: exec(code, module.__dict__))  # noqa: S102
    _guard(_join_threads)
    _guard(_run_exit_handlers)
    if b"__del__" in tracebacks.script.source + b"".join(tracebacks.script.files.values()):
        from rclpy._process.finalizing import end_imports, finalize

        end_imports()
        for name in (*workspace.modules, module):
            _guard(lambda names=name.__dict__: finalize(names))


def _launch() -> None:
    from rclpy._process.launching import launch  # the few runs that need it import it

    launch(_run_program)


def _run_program(step: Any) -> int:
    """Run one of a launch's programs; return its exit code.

    The run ends as the first one that fails, else as the first unusual one.
    """
    own = Ending()
    _guard(step, own)
    if ending.reason == _wire.FINISHED and (own.reason != _wire.FINISHED or not ending.code):
        vars(ending).update(vars(own))
    return int(own.code or own.reason != _wire.FINISHED)


def _guard(step: Any, end: Ending = ending) -> None:
    """Run one step; let whatever it raises end the script as Python would."""
    try:
        step()
    except SystemExit as error:
        _leave(error.code, end)
    except KeyboardInterrupt as error:
        if kernel.interrupted:
            end.code = 130  # the horizon's Ctrl+C: printed as at home, but no error of the script
            tracebacks.tell_caught(error.__context__, now=False)  # one that a `finally` has held up
            _print(error)
        else:
            _fail(error, end)
    except BaseException as error:
        _fail(error, end)


def _leave(code: object, end: Ending) -> None:
    if code is None:
        end.code = 0
    elif isinstance(code, int):
        end.code = code
    else:
        end.code = 1
        print(code, file=sys.stderr)  # noqa: T201


def _fail(error: BaseException, end: Ending) -> None:
    end.set_error(error)
    _print(error)


def _print(error: BaseException) -> None:
    try:
        sys.excepthook(type(error), error, error.__traceback__)
    except BaseException as second:
        print("Error in sys.excepthook:", file=sys.stderr)  # noqa: T201
        tracebacks.print_exception(second)


def _join_threads() -> None:
    """Wait for non-daemon threads as Python does."""
    threading: Any = sys.modules.get("threading")
    if threading is None:
        return
    from rclpy._patches.threads import end_main_thread

    end_main_thread(threading)
    late = kernel.interrupted
    try:
        for call in reversed(threading._threading_atexits):
            call()
        kernel.main_ended = True
        kernel.wait(_only_daemons, None, "the end of the program waits for the other threads")
    except BaseException as error:  # Ctrl+C, or what the script's handler of it raises
        if not late:  # at home nobody presses it again
            told: Any = SimpleNamespace(err_msg=None, object=threading)
            told.exc_type, told.exc_value, told.exc_traceback = type(error), error, error.__traceback__
            sys.unraisablehook(told)


def _only_daemons() -> bool:
    return all(thread.daemon for thread in kernel.threads[1:])


def _run_exit_handlers() -> None:
    import atexit

    atexit._run_exitfuncs()


def _finish() -> NoReturn:
    _flush()
    ending.send_and_exit()


def _flush() -> None:
    for stream in (sys.stdout, sys.__stdout__, sys.stderr, sys.__stderr__):
        try:
            if stream is not None:
                stream.flush()
        except (OSError, ValueError, AttributeError):
            pass  # closed or replaced by the script


def end_now(reason: str) -> NoReturn:
    """End the run from whichever thread found that it cannot go on."""
    if reason == "stalled" and not kernel.interrupted:
        ending.reason = _wire.STALLED
        ending.code = 1
        ending.text = tracebacks.explain_stall(kernel)
    elif reason == "steps":
        ending.reason = _wire.TOO_MANY_STEPS
        ending.code = 1
    elif reason.startswith("signal "):
        if tracebacks.script.aborted is not None:
            ending.set_error(tracebacks.script.aborted)
        ending.code = 128 + int(reason.split()[1])
    elif not kernel.main_ended:
        ending.code = 130
    _finish()


def _end_at_output_limit() -> NoReturn:
    """End the run at the byte it may no longer print; flushing would print more."""
    ending.reason = _wire.PRINTED_TOO_MUCH
    ending.code = 1
    ending.text = f"more than {output.budget.most_bytes} bytes were printed"
    ending.send_and_exit()


def exit_now(code: int) -> NoReturn:
    """`os._exit`: end at once, or this one of a launch's programs; buffered output is lost, as on a PC."""
    if kernel.running.program is not None:
        from rclpy._process.side_by_side import end_at_once

        ending.code = ending.code or int(code)
        end_at_once(int(code))
    ending.code = int(code)
    ending.send_and_exit()
