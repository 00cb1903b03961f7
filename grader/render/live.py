"""Replaying a drive in a terminal: turtlesim's window in braille dots, with pose and log beside it.

By then the drive is over, because its virtual time took a fraction of a second. It is replayed in real time or at
a multiple of that. Without a terminal only the last picture is printed.
"""

import math
import time
from collections.abc import Callable, Iterator

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from grader.contracts.assignment import WINDOW_M
from grader.contracts.outcome import LogRecord
from grader.contracts.trajectory import Trajectory
from grader.messages.quantity import number
from grader.render.escape import visible_line

_NANO = 1e-9
_FRAMES_PER_S = 20.0
_LINGER_NS = 1_000_000_000
_MOST_ROWS, _FEWEST_ROWS = 26, 6
_ROWS_AROUND = 4
_COLUMNS_BESIDE = 30
_DOTS_ACROSS, _DOTS_DOWN = 2, 4
_BRAILLE = 0x2800
_BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a cell's dots, row by row
_TRAIL, _TURTLE = "blue", "bold green"
_TURTLE_DOTS = ((4, 0), (3, 0), (2, 0), (1, 0), (0, 0), (-1, 0), (1, 1), (1, -1), (0, 1), (0, -1), (-1, 1),
                (-1, -1), (-2, 2), (-2, -2), (-1, 2), (-1, -2))  # fmt: skip
"""The turtle, an arrowhead: dots ahead and to the left of where it is."""


def watch(  # noqa: PLR0913
    output: Console,
    track: Trajectory,
    logs: tuple[LogRecord, ...],
    *,
    speed: float = 1.0,
    now_s: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Show the drive on `output`, `speed` times as fast as it was; KeyboardInterrupt ends it at any time."""
    film = Film(track, logs, rows=_rows(output), columns=output.width)
    if not output.is_terminal or output.is_dumb_terminal:
        output.print(film.frame(film.end_ns))
        return
    with Live(console=output, auto_refresh=False) as picture:
        begun_s = now_s()
        while True:
            t_ns = round((now_s() - begun_s) * speed * 1e9)
            picture.update(film.frame(min(t_ns, film.end_ns)), refresh=True)
            if t_ns >= film.end_ns:
                return
            sleep(1.0 / _FRAMES_PER_S)


def _rows(output: Console) -> int:
    return min(max(output.height - _ROWS_AROUND, _FEWEST_ROWS), _MOST_ROWS)


class Film:
    """The frames of a drive. `end_ns`: when nothing more is to be seen."""

    def __init__(self, track: Trajectory, logs: tuple[LogRecord, ...], *, rows: int, columns: int) -> None:
        self._track, self._logs = track, logs
        last_ns = max([int(track.t_ns[-1]), *(record.t_ns for record in logs)])
        self.end_ns = min(last_ns + _LINGER_NS, max(track.end_ns, last_ns))
        self._rows = rows
        self._beside = columns >= 2 * rows + 2 + _COLUMNS_BESIDE
        self._canvas = _Canvas(track, rows)

    def frame(self, t_ns: int) -> RenderableType:
        """Return the picture of the instant `t_ns`."""
        at = max(int(np.searchsorted(self._track.t_ns, t_ns, "right")) - 1, 0)
        picture = Panel(self._canvas.draw(at), expand=False, padding=0, border_style="dim")
        if not self._beside:
            return Group(picture, self._pose(at, t_ns, lines=1))
        beside = Group(self._pose(at, t_ns, lines=6), Text(), *self._log(t_ns, self._rows - 6))
        table = Table.grid(padding=(0, 1))
        table.add_column(width=2 * self._rows + 2, no_wrap=True)
        table.add_column(ratio=1)
        table.add_row(picture, beside)
        return table

    def _pose(self, at: int, t_ns: int, *, lines: int) -> Text:
        track = self._track
        rests = t_ns > int(track.t_ns[at])
        v, w = (0.0, 0.0) if rests and at + 1 == len(track) else (track.v_mps[at], track.w_radps[at])
        heading_deg = math.degrees(math.remainder(float(track.heading_rad[at]), math.tau))
        values = (
            f"t = {t_ns * _NANO:.2f} s",
            f"x = {track.x_m[at]:.2f} m",
            f"y = {track.y_m[at]:.2f} m",
            f"θ = {number(heading_deg, 'deg')}",
            f"v = {number(float(v), 'm/s', 2)}",
            f"ω = {number(float(w), 'rad/s', 2)}",
        )
        return Text(("\n" if lines > 1 else "  ").join(values), overflow="ellipsis", no_wrap=lines == 1)

    def _log(self, t_ns: int, most: int) -> Iterator[Text]:
        records = [record for record in self._logs if record.t_ns <= t_ns]
        for record in records[-max(most, 1) :]:
            line = f"{record.t_ns * _NANO:.2f} [{record.level_name}] {visible_line(record.message, 200)}"
            yield Text(line, overflow="ellipsis", no_wrap=True)


class _Canvas:
    """Dots in cells of two by four. The whole window is shown, and more where the car left it."""

    def __init__(self, track: Trajectory, rows: int) -> None:
        left, bottom = min(0.0, float(track.x_m.min())), min(0.0, float(track.y_m.min()))
        right, top = max(WINDOW_M, float(track.x_m.max())), max(WINDOW_M, float(track.y_m.max()))
        extent = max(right - left, top - bottom)
        self._track, self._rows, self._columns = track, rows, 2 * rows
        self._left, self._top = left, top
        self._dots_per_m = (rows * _DOTS_DOWN - 1) / extent
        self._trail: set[tuple[int, int]] = set()
        self._drawn = 0

    def draw(self, at: int) -> Text:
        """Return the picture with the trail up to sample `at` and the turtle on it; `at` never falls."""
        self._extend(at)
        cells = [[0] * self._columns for _ in range(self._rows)]
        turtle = set(self._turtle(at))
        for dots in (self._trail, turtle):
            for across, down in dots:
                if 0 <= across < self._columns * _DOTS_ACROSS and 0 <= down < self._rows * _DOTS_DOWN:
                    bit = _BITS[down % _DOTS_DOWN][across % _DOTS_ACROSS]
                    cells[down // _DOTS_DOWN][across // _DOTS_ACROSS] |= bit
        text = Text("\n".join("".join(chr(_BRAILLE + cell) for cell in row) for row in cells), style=_TRAIL)
        for across, down in turtle:
            if 0 <= across < self._columns * _DOTS_ACROSS and 0 <= down < self._rows * _DOTS_DOWN:
                place = (down // _DOTS_DOWN) * (self._columns + 1) + across // _DOTS_ACROSS
                text.stylize(_TURTLE, place, place + 1)
        return text

    def _extend(self, at: int) -> None:
        """Add the way to sample `at` to the trail; a jump leaves none."""
        jumps = set(self._track.jumps)
        while self._drawn <= at:
            here = self._place(self._drawn)
            before = here if self._drawn == 0 or self._drawn in jumps else self._place(self._drawn - 1)
            steps = max(1, math.ceil(math.dist(before, here)))
            for step in range(steps + 1):
                share = step / steps
                dot = (before[0] + (here[0] - before[0]) * share, before[1] + (here[1] - before[1]) * share)
                self._trail.add((round(dot[0]), round(dot[1])))
            self._drawn += 1

    def _place(self, at: int) -> tuple[float, float]:
        x_m, y_m = float(self._track.x_m[at]), float(self._track.y_m[at])
        return (x_m - self._left) * self._dots_per_m, (self._top - y_m) * self._dots_per_m

    def _turtle(self, at: int) -> Iterator[tuple[int, int]]:
        across, down = self._place(at)
        heading = float(self._track.heading_rad[at])
        cos, sin = math.cos(heading), math.sin(heading)
        for ahead, left in _TURTLE_DOTS:
            yield round(across + ahead * cos - left * sin), round(down - ahead * sin - left * cos)
