"""Several programs of one launch in one process, each as if it had a process of its own.

A program is a thread, with those that it starts. What a process has for itself is put aside when the turn passes
to another program, and put back when it returns: the command line, the student's modules, rclpy's default context,
executor, log levels and signal handlers, the main thread. Only one thread runs at a time, so no program ever
sees another one's. They meet in the graph alone. At Ctrl+C each gets its own, as from a terminal.

Not of their own are the state of Python's other modules (`random`, `logging`, functions of `atexit`), files, the
alarm, and the steps that a run may make.
"""

from __future__ import annotations

import _frozen_importlib
import gc
import os
import sys
import threading
from concurrent.futures import thread as pools
from types import ModuleType
from weakref import WeakKeyDictionary

import rclpy
from rclpy import context, signals, utilities
from rclpy._kernel import MAX_THREADS, Thread, kernel
from rclpy._patches.locks import deadline_after
from rclpy._patches.signal import signals as handlers
from rclpy._patches.threads import start
from rclpy._process.packages import executable_path, workspace
from rclpy._rcl import handles, logs
from rclpy._rcl.endpoints import EndpointHandle
from rclpy._rcl.enums import SignalHandlerOptions
from rclpy._rcl.node_handle import NodeHandle
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, NoReturn

    Guard = Callable[[Callable[[], None]], int]

_AT_EXIT = "_threading_atexits"
_OWN: tuple[tuple[Any, str, Callable[[Program], Any]], ...] = (
    (sys, "argv", lambda program: program.argv),
    (sys, "orig_argv", lambda program: [sys.executable, *program.argv]),
    (kernel, "main", lambda program: program.thread),
    (kernel, "main_ended", lambda program: False),
    (kernel, "on_terminate", lambda program: None),
    (kernel, "_signals", lambda program: []),
    (kernel, "_on_interrupt", lambda program: []),
    (handlers, "handlers", lambda program: dict(handlers.handlers)),
    (handles, "_live_contexts", lambda program: []),
    (utilities, "g_default_context", lambda program: None),
    (rclpy, "_executor", lambda program: None),
    (signals, "_installed", lambda program: SignalHandlerOptions.NO),
    (signals, "_registered", lambda program: False),
    (context, "g_logging_ref_count", lambda program: 0),
    (logs, "_settings", lambda program: None),
    (logs, "_levels", lambda program: {}),
    (logs, "_rosout", lambda program: {}),
    (logs, "_rosout_open", lambda program: False),
    (logs, "_nodes", lambda program: {}),
    (logs, "_late", lambda program: {}),
    (threading, "_main_thread", lambda program: _MainThread(program.thread)),
    (threading, _AT_EXIT, lambda program: list(getattr(threading, _AT_EXIT))),
    (pools, "_shutdown", lambda program: False),
    (pools, "_threads_queues", lambda program: WeakKeyDictionary()),
    # one that never ends loading a module holds up no other
    (_frozen_importlib, "_module_locks", lambda program: {}),
    (os.environ, "_data", lambda program: _encoded(program.environment)),
    (storage, "cwd", lambda program: storage.cwd),
)
"""What each program has for itself: an object, the name of its attribute, and what it is at first."""


class Program:
    """One executable of a launch, with what it has for itself while another one runs.

    Attributes:
        package, executable, arguments: what is started, as `action` of the launch file says.
        delay_s: how long after the launch file, or after what it waited for.
        cwd: where it works; None: where the launch does.
        ended: whether its process would be gone.
    """

    def __init__(self, node: Any) -> None:
        self.action, self.package, self.executable = node.action, node.package, node.executable
        self.arguments: list[str] = node.arguments
        self.delay_s: float = node.delay_s
        self.environment: dict[str, str] = node.environment
        self.cwd: str | None = node.cwd
        self.ended = False
        self.thread: Thread
        self.argv: list[str] = []
        self.values: list[Any] = []
        self.modules: dict[str, ModuleType] = {}

    def main_thread(self) -> Thread:
        """Return the program's main thread, not started, and note what the program has for itself at first."""
        self.thread = thread = kernel.new_thread(f"main thread of {self.executable}", False)
        thread.program = self
        called = executable_path(self.package, self.executable)
        self.argv = [called, *self.arguments]
        main = ModuleType("__main__")
        vars(main).update({"__file__": called, "__builtins__": __builtins__, "__cached__": None})
        self.modules = {"__main__": main}
        self.values = [at_start(self) for _, _, at_start in _OWN]
        return thread


def _encoded(environment: dict[str, str]) -> dict[bytes, bytes]:
    """Return what `os.environ` keeps of an environment."""
    return {os.fsencode(name): os.fsencode(value) for name, value in environment.items()}


class _MainThread(threading.Thread):
    """What `threading` takes for the main thread of one program."""

    _started: threading.Event

    def __init__(self, thread: Thread) -> None:
        super().__init__(name="MainThread", daemon=False)
        self._started.set()
        self._ident = thread.ident
        self._kernel_thread = thread
        active: dict[int, threading.Thread] = getattr(threading, "_active")  # noqa: B009 - unknown to mypy
        active[thread.ident] = self

    def is_alive(self) -> bool:
        kernel.charge()
        return self._kernel_thread in kernel.threads

    def join(self, timeout: float | None = None) -> None:
        kernel.wait(lambda: self._kernel_thread not in kernel.threads, deadline_after(timeout))


class _Images:
    """Which program's own things are in place, and the programs of the launch; None stands for launch itself."""

    guard: Guard
    launched: Any

    def __init__(self) -> None:
        self.programs: list[Program] = []
        self.launch: Any = None
        self.own_modules: list[str] = []

    def begin(self, names: list[str]) -> None:
        """From now on the kernel changes images with the turns."""
        self.own_modules = ["__main__", *names]
        self.launch = Program.__new__(Program)
        self.launch.values, self.launch.modules = [], {}
        kernel.switch = self.switch
        kernel.everywhere = self.everywhere

    def add(self, nodes: list[Any]) -> None:
        """Start the programs of some nodes, in this order.

        Raises RuntimeError: there are more than there can be threads.
        """
        count = len(nodes) + sum(not each.ended for each in self.programs)
        if count >= MAX_THREADS:
            raise RuntimeError(f"{count} nodes of your own, of which {MAX_THREADS - 1} can run at once here")
        programs = [Program(node) for node in nodes]
        self.programs += programs
        threads = [program.main_thread() for program in programs]  # all, before the first one may run
        for program, thread in zip(programs, threads, strict=True):
            start(thread, _live, (program, self.guard), {})

    def follow(self, program: Program, code: int) -> None:
        """Start what is to come after a program's end. After Ctrl+C launch starts nothing more."""
        if not kernel.interrupted:
            self.guard(lambda: self.add(self.launched.after(program.action, code)))

    def switch(self, old: Any, new: Any) -> None:
        """Put one program's own things aside and another one's in place."""
        modules, kept = sys.modules, {}
        for name in self.own_modules:
            if name in modules:
                kept[name] = modules.pop(name)
        values = [getattr(place, name) for place, name, _ in _OWN]
        old = self.launch if old is None else old
        new = self.launch if new is None else new
        old.modules, old.values = kept, values
        modules.update(new.modules)
        for (place, name, _), value in zip(_OWN, new.values, strict=True):
            setattr(place, name, value)

    def everywhere(self, act: Callable[[], None]) -> None:
        """Do something in each program that has not ended, and in launch itself."""
        present = kernel.running.program
        act()
        for program in (None, *self.programs):
            if program is not present and (program is None or not program.ended):
                self.switch(present, program)
                act()
                kernel.called.append(kernel.main)
                self.switch(program, present)


images = _Images()


def run(nodes: list[Any], guard: Guard, launched: Any) -> None:
    """Start the nodes' programs in this order, and return when all have ended.

    Args:
        nodes: of the student's packages, as the launch file described them.
        guard: calls a function, takes what it raises for the program's end, and returns the exit code of that.
        launched: knows which nodes start when the process of an action ends, and when everything is to end.

    Raises:
        RuntimeError: there are more than there can be threads.
    """
    images.guard, images.launched = guard, launched
    images.begin(workspace.module_names())
    images.add(nodes)
    while not _all_ended():
        try:
            _wait_for_end(launched)
        except KeyboardInterrupt:  # each of them has got its own
            guard(lambda: launched.shut_down("ctrl-c (SIGINT)", due_to_sigint=True))
    guard(lambda: launched.shut_down("idle"))


def _all_ended() -> bool:
    return all(program.ended for program in images.programs)


def _wait_for_end(launched: Any) -> None:
    """Wait until all programs have ended, or it is time for the launch file's own end of everything."""
    due_ns: int | None = None if kernel.interrupted else launched.shutdown_ns
    kernel.wait(
        lambda: _all_ended() or (launched.shutdown_ns != due_ns and not kernel.interrupted),
        due_ns,
        "launch waits for its nodes",
        idle=True,
    )
    if due_ns is not None and kernel.now_ns >= due_ns and not _all_ended():
        kernel.interrupt()


def _live(program: Program, guard: Guard) -> None:
    """Be a program from its start to its end."""
    code = guard(lambda: _call(program))
    code = guard(_join_threads) or code
    _close(program, code)


def _call(program: Program) -> None:
    if program.delay_s > 0.0:
        try:
            kernel.sleep_ns(round(program.delay_s * 1e9))
        except KeyboardInterrupt:
            return  # launch starts nothing more
    if program.cwd is not None:
        os.chdir(program.cwd)
    workspace.choose(program.package, program.executable)
    workspace.call()


def _join_threads() -> None:
    """Wait for the program's threads that are no daemons; after Ctrl+C nobody waits any more."""
    me = kernel.running
    if not kernel.interrupted:
        for call in reversed(getattr(threading, _AT_EXIT)):
            call()
        kernel.main_ended = True
        others = "the end of a node's program waits for its other threads"
        kernel.wait(
            lambda: all(
                thread.daemon
                for thread in kernel.threads
                if thread.program is me.program and thread is not me
            ),
            None,
            others,
        )


def _close(program: Program, code: int) -> None:
    """Release what a process releases at its end: its entities, and its other threads.

    From then on the running thread is launch's, because a program that has ended gets no signals.
    """
    program.ended = True
    me = kernel.running
    # `isinstance` asks an object for its class, and a proxy of something that is gone then raises
    handles = [thing for thing in gc.get_objects() if issubclass(type(thing), (EndpointHandle, NodeHandle))]
    endpoints = [
        handle for handle in handles if isinstance(handle, EndpointHandle) and _is_of(program, handle.node)
    ]
    nodes = [handle for handle in handles if isinstance(handle, NodeHandle) and _is_of(program, handle)]
    endpoints.sort(key=lambda endpoint: endpoint.gid)
    nodes.sort(key=lambda node: node.link_id)
    for handle in (*endpoints, *nodes):
        if not handle.doomed:
            handle.doomed = True
            handle._dispose()  # even if a thread is inside: it never goes on
    kernel.threads[:] = [thread for thread in kernel.threads if thread is me or thread.program is not program]
    kernel.called[:] = [call for call in kernel.called if call.program is not program]
    images.switch(program, None)
    me.program = None
    images.follow(program, code)
    kernel.replan()


def _is_of(program: Program, node: NodeHandle) -> bool:
    return node.context.program is program


def end_at_once(code: int) -> NoReturn:
    """End the running thread's program without another line of it: `os._exit`."""
    me = kernel.running
    assert isinstance(me.program, Program)
    _close(me.program, code)
    kernel.end_thread(me)
    while True:  # the process's end takes the thread along
        me.baton.acquire()
