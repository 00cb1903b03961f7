"""Check ``agent``: a chat agent drives the car through the services that the script offers, and by itself."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any, Final

import numpy as np

from grader.checks.fit import Misfit, is_number
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake, mistake
from grader.checks.offers import unanswered
from grader.contracts.assignment import Assignment, ServiceCall
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import AgentResult, RunStatus, ServiceResult
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import COMMAND_LIFE_NS, Trajectory
from grader.geometry import exact
from grader.messages.quantity import number

MEASURES = {
    "nodes": MeasureKind(form="count", of="service"),
    "offered": MeasureKind(form="count"),
    "answered": MeasureKind("%"),
    "move_error": MeasureKind("%"),
    "turn_error": MeasureKind("deg"),
    "told_error": MeasureKind("m"),
    "alive": MeasureKind(form="flag", of="node"),
}
_STILL_M: Final = 0.02
_STILL_DEG: Final = 2.0
_ENDLESS: Final = 2.0  # times the wanted turn: a turn beyond it does not end by itself
_NEAR: Final = 0.1  # of a wanted motion: within it, a motion counts as the opposite one

Place = tuple[float, float, float]
"""x and y in metres, heading in degrees, unwrapped."""
_NO_STEPS = Text(zh="缺少：写明智能体的工具调用", en="missing; list the agent's tool calls")
_NO_TURTLE = Text(
    zh="智能体只能驾驶 turtlesim 的小车：删掉", en="an agent drives turtlesim's car only; remove it"
)


class _Motion:
    """What the car did between the sending of one step and that of the next."""

    def __init__(self, result: AgentResult, track: Trajectory, end_ns: int) -> None:
        self.step = result.step
        self.begin_ns, self.end_ns = result.sent_ns or 0, end_ns
        begin, end = _place(track, self.begin_ns), _place(track, end_ns)
        x, y = end[0] - begin[0], end[1] - begin[1]
        heading = math.radians(begin[2])
        cos, sin = exact.cos_sin(heading)
        self.ahead_m, self.aside_m = x * cos + y * sin, y * cos - x * sin
        self.turned_deg = end[2] - begin[2]
        self.sent = result.sent_ns is not None

    @property
    def move_error_pct(self) -> float:
        """Distance from where the car should have come, in percent of the wanted way; 100 at most."""
        wanted = self.step.moves_m or 0.0
        if not self.sent:
            return 100.0
        return min(100.0 * exact.hypot(self.ahead_m - wanted, self.aside_m) / abs(wanted or 1.0), 100.0)

    @property
    def turn_error_deg(self) -> float:
        """How far the turn was from the wanted one."""
        wanted = self.step.turns_deg or 0.0
        return abs(wanted) if not self.sent else abs(self.turned_deg - wanted)


def measure(assignment: Assignment, run: Run) -> Measures:
    """See what the agent's tool calls came to."""
    motions = list(_motions(run))
    calls = _calls(assignment, run)
    alive = run.outcome.status is RunStatus.INTERRUPTED
    offered = {call.call.service for call in calls if call.sent_ns is not None}
    answers = sum(call.answered_ns is not None for call in calls)
    nodes = run.outcome.nodes
    return {
        "nodes": Measure(float(len(nodes)), {"names": ", ".join(nodes[:4]) or "—"}),
        "offered": Measure(float(len(offered)), {"names": ", ".join(sorted(offered)) or "—"}),
        "answered": Measure(100.0 * answers / max(len(calls), 1), {"answers": answers, "calls": len(calls)}),
        "move_error": _move_error(motions),
        "turn_error": _turn_error(motions),
        "told_error": _report_error(run),
        "alive": Measure(float(alive), {"seconds": number(run.outcome.duration_ns / 1e9, "s")}),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    motions = list(_motions(run))
    found = unanswered(run, _calls(assignment, run)) or tuple(_mistakes(run, motions))
    if found and found[0].code == "service_silent":
        found = tuple(_endless_turns(motions)) or found
    return found


def _calls(assignment: Assignment, run: Run) -> list[ServiceResult]:
    """Return what became of the calls of the script's services; turtlesim's are the car's."""
    return [
        ServiceResult(
            call=ServiceCall(at_ns=one.step.at_ns, service=one.step.target, type=one.step.type),
            sent_ns=one.sent_ns,
            answered_ns=one.answered_ns,
            values=one.values,
        )
        for one in run.agent
        if one.step.tool == "call" and not one.step.type.startswith("turtlesim/")
    ]


def _motions(run: Run) -> Iterator[_Motion]:
    """Yield what the car did in each step that asks for a motion."""
    ends = [*(one.sent_ns for one in run.agent[1:]), None]
    for index, result in enumerate(run.agent):
        if result.step.moves_m is None and result.step.turns_deg is None:
            continue
        later = next((end for end in ends[index:] if end is not None), run.trajectory.end_ns)
        yield _Motion(result, run.trajectory, later)


def _place(track: Trajectory, t_ns: int) -> Place:
    """Return where the car was at `t_ns`: a resting car is sampled when it comes to rest and when it leaves."""
    index = max(int(np.searchsorted(track.t_ns, t_ns, side="right")) - 1, 0)
    heading_deg = math.degrees(float(track.heading_rad[index]))
    return float(track.x_m[index]), float(track.y_m[index]), heading_deg


def _move_error(motions: list[_Motion]) -> Measure:
    found = [one for one in motions if one.step.moves_m is not None]
    if not found:
        return UNMEASURED
    worst = max(found, key=lambda one: one.move_error_pct)
    wanted, driven = number(worst.step.moves_m or 0.0, "m"), number(worst.ahead_m, "m")
    return Measure(worst.move_error_pct, {"wanted": wanted, "driven": driven})


def _turn_error(motions: list[_Motion]) -> Measure:
    found = [one for one in motions if one.step.turns_deg is not None]
    if not found:
        return UNMEASURED
    worst = max(found, key=lambda one: one.turn_error_deg)
    wanted, turned = number(worst.step.turns_deg or 0.0, "deg"), number(worst.turned_deg, "deg")
    return Measure(worst.turn_error_deg, {"wanted": wanted, "turned": turned})


def _reported_places(run: Run) -> Iterator[tuple[Place, Place]]:
    """Yield the true and the reported place of the car, for each answer that tells a place."""
    for one in run.agent:
        if one.step.tells and one.answered_ns is not None:
            x, y = (_number((one.values or {}).get(field)) for field in one.step.tells)
            yield _place(run.trajectory, one.answered_ns), (x, y, 0.0)


def _report_error(run: Run) -> Measure:
    """Return the largest distance of an answer from the car; unmeasured unless every answer tells a place."""
    wanted = sum(bool(one.step.tells) for one in run.agent)
    pairs = list(_reported_places(run))
    errors = [exact.apart(true[:2], reported[:2]) for true, reported in pairs]
    if len(errors) < wanted or not errors or not all(map(math.isfinite, errors)):
        return UNMEASURED
    worst = max(range(len(errors)), key=errors.__getitem__)
    true, reported = pairs[worst]
    return Measure(errors[worst], {"told": _point(reported), "true": _point(true)})


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _point(place: Place) -> str:
    return f"({place[0]:.2f}, {place[1]:.2f})"


def _mistakes(run: Run, motions: list[_Motion]) -> Iterator[Mistake]:
    """Yield why the car moved otherwise than the agent asked."""
    moves = [(one.step.moves_m, one.ahead_m, one.step.target) for one in motions if one.step.moves_m]
    turns = [(one.step.turns_deg, one.turned_deg, one.step.target) for one in motions if one.step.turns_deg]
    once = tuple(_single_commands(run, motions))
    if once and (_deviating(moves, _STILL_M) or _deviating(turns, _STILL_DEG)):
        yield from once
        return
    by_number = all(map(_has_number, motions))
    yield from _wrong_motions(moves, _STILL_M, "move_error", "m", by_number=by_number)
    yield from _wrong_motions(turns, _STILL_DEG, "turn_error", "deg", by_number=by_number)
    pairs = list(_reported_places(run))
    driven_m = [exact.apart(a[0][:2], b[0][:2]) for a, b in pairwise(pairs)]
    reported_m = [exact.apart(a[1][:2], b[1][:2]) for a, b in pairwise(pairs)]
    if any(far > 0.1 and change < _STILL_M for far, change in zip(driven_m, reported_m, strict=True)):
        yield mistake("told_stale", ("told_error",))


def _endless_turns(motions: list[_Motion]) -> Iterator[Mistake]:
    """Yield that degrees were taken for radians: the first turn goes on long after it should have ended."""
    first = next((one for one in motions if one.step.turns_deg), None)
    if (
        first is not None
        and _has_number(first)
        and abs(first.turned_deg) > _ENDLESS * abs(first.step.turns_deg or 0.0)
    ):
        yield mistake("tool_takes_degrees", ("answered", "turn_error"), tool=first.step.target)


def _has_number(motion: _Motion) -> bool:
    """Return whether the request has a number: a tool that gets none cannot misread one."""
    return any(map(is_number, motion.step.values.values()))


def _single_commands(run: Run, motions: list[_Motion]) -> Iterator[Mistake]:
    """Yield that motions ended because one command acts for a second only."""
    driven = [(one.t_ns, one.v_mps, one.w_radps) for one in run.trajectory.commands]
    silences = []
    for motion in motions:
        begun = [t_ns for t_ns, *twist in driven if motion.begin_ns <= t_ns < motion.end_ns and any(twist)]
        if len(begun) == 1:
            later = next((t_ns for t_ns, *_ in driven if t_ns > begun[0]), run.trajectory.end_ns)
            silences.append(later - begun[0])
    if silences and len(silences) == len(motions) and max(silences) > COMMAND_LIFE_NS:
        silence = number(max(silences) / 1e9, "s")
        yield mistake("published_once", ("move_error", "turn_error"), times=len(silences), silence=silence)


def _wrong_motions(
    motions: list[tuple[float, float, str]], still: float, measure: str, unit: Any, *, by_number: bool
) -> Iterator[Mistake]:
    """Yield what is wrong about motions of one kind, each (wanted, done, tool).

    `by_number`: all their requests have a number.
    """
    wrong = _deviating(motions, still)
    if not wrong:
        return
    wanted, done, tool = wrong[0]
    values: Mapping[str, object] = {"tool": tool, "wanted": number(wanted, unit), "done": number(done, unit)}
    amounts = [abs(each[1]) for each in motions]
    if all(abs(each[1]) <= still for each in motions):
        yield mistake("tool_moves_nothing", (measure,), **values)
    elif not by_number:
        return
    elif all(abs(each[1] + each[0]) <= max(_NEAR * abs(each[0]), still) for each in wrong):
        yield mistake("tool_ignores_sign", (measure,), **values)
    elif len({abs(each[0]) for each in motions}) > 1 and max(amounts) - min(amounts) <= still:
        yield mistake("tool_ignores_request", (measure,), **values)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of the bare path."""
    return FigureSketch()


def _deviating(motions: list[tuple[float, float, str]], still: float) -> list[tuple[float, float, str]]:
    """Return the motions that deviate from the wanted ones."""
    return [one for one in motions if abs(one[1] - one[0]) > max(_NEAR * abs(one[0]), still)]


def _consult(assignment: Assignment) -> Iterator[Misfit]:
    if assignment.world.kind == "robot":
        yield "world.kind", _NO_TURTLE
    elif not assignment.agent:
        yield "agent", _NO_STEPS


CHECK = Check(
    kind="agent", measures=MEASURES, consult=_consult, measure=measure, explain=explain, sketch=sketch
)
