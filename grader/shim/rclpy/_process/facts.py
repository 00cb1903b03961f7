"""What a traced run tells of its script: the syntax tree, and a ledger of the motions and of the lines that ran.

Only a run that looks for an explanation is traced; it is driven like any other, because tracing takes no virtual
time. The tree is sent before the script's first line runs, the ledger at the end, in pieces (FACTS in
docs/design.md, "Wire"). A script could falsify the ledger; nothing but words depends on it.
"""

from __future__ import annotations

import contextlib
import json
import math
import sys

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._patches.tracebacks import script
from rclpy._process.tree import MOST_INTEGER, tree_rows
from rclpy.publisher import Publisher

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any

FACTS = 0x32
TREE, LEDGER = 1, 2

PIECE_BYTES = 60_000
MOST_EVENTS = 150_000
"""Lines that are traced; a longer script runs on untraced, so that it takes no longer than the limits allow."""
MOST_MOTIONS = 120
MOST_LINES = 4_000
MOST_WAITS = 12
MOST_NAMES = 10
MOST_FRAMES = 6
MOST_CHARACTERS = 60


def send_tree(source: bytes, file_name: str) -> None:
    """Send the script's syntax tree, if it has one that is not too large."""
    if rows := tree_rows(source, file_name):
        _send(TREE, rows)


def _send(what: int, content: object) -> None:
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":")).encode()
    link.flush()
    for start in range(0, len(text), PIECE_BYTES):
        link.send_frame(bytes((FACTS, what)) + text[start : start + PIECE_BYTES])


class Ledger:
    """Takes down what the script's lines did to the car, and when.

    Attributes:
        ran: lines that have run. motions: one for each row of equal commands from one line.
        stopped: the script's lines at the horizon's Ctrl+C, from the inside out.
    """

    def __init__(self) -> None:
        self.ran: set[int] = set()
        self.motions: list[dict[str, Any]] = []
        self.stopped: list[list[Any]] = []
        self._waits: dict[int, list[int]] = {}
        self._last: dict[int, tuple[int, int]] = {}
        self._left = MOST_EVENTS

    def begin(self) -> None:
        """Trace the script from its first line on."""
        import threading

        publish = Publisher.publish

        def noted(publisher: Publisher, msg: Any) -> None:
            self._take(publisher, msg)
            publish(publisher, msg)

        setattr(Publisher, "publish", noted)  # noqa: B010 - mypy takes a method for read-only
        before_exit, at_horizon = link.before_exit, kernel.at_horizon

        def end() -> None:
            sys.settrace(None)
            before_exit()
            self.send()

        def interrupted() -> None:
            self.stopped = _stack(sys._current_frames().get(kernel.main.os_ident))
            at_horizon()

        link.before_exit, kernel.at_horizon = end, interrupted
        threading.settrace(self._enter)
        sys.settrace(self._enter)

    def send(self) -> None:
        """Send what was taken down."""
        ran = sorted(self.ran)[:MOST_LINES]
        with contextlib.suppress(Exception):  # the script may have changed what this is made of
            whole = self._left >= 0 and len(ran) < MOST_LINES
            _send(LEDGER, {"ran": ran, "motions": self.motions, "end": self.stopped, "whole": whole})

    def _enter(self, frame: FrameType, event: str, argument: object) -> Any:
        return self._step if script.owns(frame.f_code.co_filename) else None

    def _step(self, frame: FrameType, event: str, argument: object) -> Any:
        """Take down a line, and for how long the line before it in this thread kept the thread waiting."""
        if event != "line":
            return self._step
        self._left -= 1
        if self._left < 0:
            sys.settrace(None)
            return None
        line, now_ns = frame.f_lineno, kernel.now_ns
        self.ran.add(line)
        thread = kernel.running.ident
        before, since_ns = self._last.get(thread, (0, now_ns))
        self._last[thread] = (line, now_ns)
        if now_ns - since_ns > 1_000_000 and before:
            waited = self._waits.get(before)
            if waited is not None:
                waited[0] += 1
                waited[1] += now_ns - since_ns
            elif len(self._waits) < MOST_WAITS:
                self._waits[before] = [1, now_ns - since_ns]
        return self._step

    def _take(self, publisher: Publisher, msg: Any) -> None:
        """Take down a message; one like the last from the same line only lengthens that one's motion."""
        try:
            speed, turn = float(msg.linear.x), float(msg.angular.z)
        except Exception:
            return
        if not (math.isfinite(speed) and math.isfinite(turn)) or len(self.motions) >= MOST_MOTIONS:
            return
        frame: FrameType | None = sys._getframe(2)
        line = _line(frame)
        last = self.motions[-1] if self.motions else None
        if last is not None and (last["v"], last["w"], last["line"]) == (speed, turn, line):
            last["times"] += 1
            last["until"] = kernel.now_ns
            return
        self._waits = {}
        self.motions.append(
            {
                "v": speed,
                "w": turn,
                "line": line,
                "t": kernel.now_ns,
                "until": kernel.now_ns,
                "times": 1,
                "topic": str(publisher.topic)[:MOST_CHARACTERS],
                "stack": _stack(frame),
                "waits": self._waits,
            }
        )


def _line(frame: FrameType | None) -> int:
    while frame is not None and not script.owns(frame.f_code.co_filename):
        frame = frame.f_back
    return 0 if frame is None else frame.f_lineno


def _stack(frame: FrameType | None) -> list[list[Any]]:
    """Return the script's lines from the inside out: line, function, and the numbers that its names stand for."""
    rows: list[list[Any]] = []
    while frame is not None and len(rows) < MOST_FRAMES:
        if script.owns(frame.f_code.co_filename):
            is_module = frame.f_code.co_name == "<module>"
            rows.append(
                [frame.f_lineno, frame.f_code.co_name[:MOST_CHARACTERS], {} if is_module else _numbers(frame)]
            )
        frame = frame.f_back
    return rows


def _numbers(frame: FrameType) -> dict[str, float]:
    numbers: dict[str, float] = {}
    for name, value in frame.f_locals.items():
        if len(numbers) >= MOST_NAMES:
            break
        if type(value) in (int, float) and abs(value) < MOST_INTEGER:
            numbers[name[:MOST_CHARACTERS]] = value
    return numbers


ledger = Ledger()
