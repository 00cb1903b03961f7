"""Quantities over time: speed and yaw rate as commanded and as driven, and the angle turned."""

import numpy as np
from matplotlib.axes import Axes

from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Floats, Trajectory
from grader.messages import quantity
from grader.render import palette
from grader.render.scene import Scene

_NANO = 1e-9
_SECOND_NS = 1_000_000_000
_AT_REST_S = 0.05
"""The recorder leaves out a car at rest, so samples further apart than this enclose a rest."""
_LEAST_RANGE = 0.5


def draw_speed(axes: Axes, scene: Scene) -> None:
    """Draw v over time."""
    track = scene.trajectory
    axes.set_ylabel(scene.word("v_axis"))
    _time_axis(axes, scene)
    if track is not None:
        commanded = [command.v_mps for command in track.commands]
        _draw(axes, scene, track, track.v_mps, commanded)
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=2,
            frameon=False,
            fontsize=9.5,
            borderaxespad=0.2,
        )


def draw_yaw_rate(axes: Axes, scene: Scene) -> None:
    """Draw w over time."""
    track = scene.trajectory
    axes.set_ylabel(scene.word("w_axis"))
    axes.set_xlabel(scene.word("time_axis"))
    _time_axis(axes, scene)
    if track is not None:
        commanded = [command.w_radps for command in track.commands]
        _draw(axes, scene, track, track.w_radps, commanded)


def draw_turned(axes: Axes, scene: Scene) -> None:
    """Draw the angle turned since the start over time, with the wanted turn in either direction."""
    track = scene.trajectory
    axes.set_ylabel(scene.word("turned_axis"))
    _time_axis(axes, scene)
    if track is None:
        return
    turned_deg = np.rad2deg(track.heading_rad - track.heading_rad[0])
    seconds = np.append(track.t_ns, max(track.end_ns, int(track.t_ns[-1]))) * _NANO
    axes.plot(
        seconds,
        np.append(turned_deg, turned_deg[-1]),
        color=_colour_of_turn(scene),
        lw=2.2,
        label=scene.word("turned"),
    )
    wanted_deg = scene.sketch.wanted_turn_deg if scene.sketch else None
    if wanted_deg is not None:
        level = wanted_deg if turned_deg[np.abs(turned_deg).argmax()] >= 0 else -wanted_deg
        axes.axhline(
            level,
            color=palette.MUTED,
            lw=1.4,
            ls=(0, (5, 3)),
            label=f"{scene.word('one_turn')} {quantity.number(abs(level), 'deg')}",
        )
        axes.margins(y=0.12)
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=9.5, borderaxespad=0.2
    )


def _colour_of_turn(scene: Scene) -> str:
    corners = scene.sketch.corners if scene.sketch else ()
    return palette.FAILED if corners and corners[0].ok is False else palette.PASSED


def _draw(axes: Axes, scene: Scene, track: Trajectory, values: Floats, commanded: list[float]) -> None:
    axes.axhline(0.0, color=palette.FAINT, lw=0.8, zorder=1)
    if track.commands:
        times, levels = _held(track.commands, commanded, track.end_ns)
        axes.plot(
            times, levels, color=palette.COMMAND, lw=4.5, alpha=0.55, solid_joinstyle="miter", zorder=2,
            label=scene.word("commanded"),
        )  # fmt: skip
    times, driven = _with_rests(track, values)
    axes.plot(times, driven, color=palette.PASSED, lw=1.5, zorder=3, label=scene.word("driven"))
    low, high = min(float(np.min(driven)), *commanded, 0.0), max(float(np.max(driven)), *commanded, 0.0)
    half = 0.56 * max(high - low, _LEAST_RANGE)
    axes.set_ylim((low + high) / 2 - half, (low + high) / 2 + half)


def _time_axis(axes: Axes, scene: Scene) -> None:
    recorded_ns = scene.trajectory.end_ns if scene.trajectory is not None else 0
    axes.set_xlim(0.0, (recorded_ns or scene.outcome.duration_ns or _SECOND_NS) * _NANO)
    axes.grid(axis="both", color=palette.GRID, lw=0.8)


def _held(commands: tuple[Command, ...], values: list[float], end_ns: int) -> tuple[Floats, Floats]:
    """Return the step line of a command that holds until the next one, or for its life."""
    starts = np.array([command.t_ns for command in commands]) * _NANO
    nexts = np.append(starts[1:], max(end_ns * _NANO, starts[-1]))
    ends = np.minimum(nexts, starts + COMMAND_LIFE_NS * _NANO)
    times: list[float] = [0.0, float(starts[0])]
    levels: list[float] = [0.0, 0.0]
    for start, end, until, value in zip(starts, ends, nexts, values, strict=True):
        times += [start, end]
        levels += [value, value]
        if until > end:
            times += [end, until]
            levels += [0.0, 0.0]
    return np.array(times), np.array(levels)


def _with_rests(track: Trajectory, values: Floats) -> tuple[Floats, Floats]:
    """Return time and values with zeros where the recorder left out a car at rest."""
    seconds = np.append(track.t_ns, max(track.end_ns, int(track.t_ns[-1]))) * _NANO
    levels = np.append(values, 0.0 if seconds[-1] > seconds[-2] else values[-1])
    rests = np.flatnonzero(np.diff(seconds) > _AT_REST_S)
    edge_s = 1e-4
    places = np.repeat(rests + 1, 2)
    times = np.column_stack((seconds[rests] + edge_s, seconds[rests + 1] - edge_s)).ravel()
    return np.insert(seconds, places, times), np.insert(levels, places, 0.0)
