"""What one plot shows, in the chosen language."""

from dataclasses import dataclass

from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, View
from grader.contracts.outcome import RunOutcome
from grader.contracts.report import GradeReport
from grader.contracts.rubric import summed
from grader.contracts.text import Language
from grader.contracts.trajectory import Trajectory
from grader.messages import quantity
from grader.render.labels import word

_MOVED_M = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """One run of a submission, ready to be drawn.

    Attributes:
        score: the score line, e.g. ``得分 8 / 10``; empty where nothing is scored. full: full marks.
        walls: whether turtlesim's window has walls.
        trajectory: None when nothing was recorded.
    """

    language: Language
    title: str
    score: str
    full: bool
    summary: str
    outcome: RunOutcome
    trajectory: Trajectory | None
    sketch: FigureSketch | None
    walls: bool

    @property
    def view(self) -> View:
        """Kind of plot: what the sketch says, else what was said, or log lines, for a car that never moved."""
        if self.sketch is not None:
            return self.sketch.view
        if self.trajectory is not None and self.trajectory.sayings and not self.moved:
            return "talk"
        return "path" if self.moved or not self.outcome.logs else "log"

    @property
    def moved(self) -> bool:
        """Whether the car left its place or turned."""
        track = self.trajectory
        if track is None or len(track) < 2:
            return False
        reach = max(float(track.x_m.max() - track.x_m.min()), float(track.y_m.max() - track.y_m.min()))
        return reach > _MOVED_M or float(track.heading_rad.max() - track.heading_rad.min()) > _MOVED_M

    def word(self, key: str, **values: object) -> str:
        """Return one of the renderers' words in this scene's language."""
        return word(key, self.language, **values)


def compose(  # noqa: PLR0913, PLR0917
    assignment: Assignment,
    report: GradeReport,
    trajectory: Trajectory | None,
    sketch: FigureSketch | None,
    language: Language,
    case: str | None = None,
) -> Scene:
    """Return the scene of one of the report's runs; of several, with the points of that one.

    Raises ValueError: the report has no such run.
    """
    run = report.run_of(case)
    if run is None:
        message = "a report without runs has nothing to plot"
        raise ValueError(message)
    title = assignment.title.get(language)
    earned, points = report.score, report.max_score
    if len(report.runs) > 1:
        title = f"{title} · {_case_title(assignment, run.case, language)}"
        own = [item for item in report.items if item.id.startswith(f"{run.case}/")]
        earned = None if report.score is None else summed(item.earned for item in own)
        points = summed(item.points for item in own)
    return Scene(
        language=language,
        title=title,
        score=_points(earned, points, language) if points else "",
        full=points > 0.0 and earned is not None and earned >= points,
        summary=report.summary.get(language),
        outcome=run.outcome,
        trajectory=trajectory,
        sketch=sketch,
        walls=assignment.world.window,
    )


def _points(earned: float | None, points: float, language: Language) -> str:
    shown = word("not_yet", language) if earned is None else quantity.points(earned)
    return f"{word('score', language)} {shown} / {quantity.points(points)}"


def _case_title(assignment: Assignment, case_id: str, language: Language) -> str:
    titles = (case.title.get(language) for case in assignment.cases if case.id == case_id)
    return next(titles, "") or case_id
