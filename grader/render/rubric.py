"""What a student reads before submitting: `grader assignments list` and `show`."""

from collections.abc import Iterator, Sequence

from rich import box
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from grader.contracts.assignment import DEFAULT_DISTRO, DEFAULT_WAY, Assignment
from grader.contracts.rubric import PublishedItem, PublishedRubric
from grader.contracts.text import Language
from grader.messages import quantity
from grader.render.escape import visible, visible_line
from grader.render.labels import word
from grader.render.prose import Prose

_WANTED_COLUMNS = 24


def render_rubric(assignment: Assignment, rubric: PublishedRubric, *, language: Language) -> RenderableType:
    """Return title, task, one row for each rubric item, and how the motion is looked at."""
    return Group(*_parts(assignment, rubric, language))


def render_list(assignments: Sequence[Assignment], *, language: Language) -> RenderableType:
    """Return one row for each assignment: id, title, points. `render_rubric` has the task."""
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column("id", no_wrap=True)
    table.add_column(word("assignment", language), ratio=1)
    table.add_column(word("worth_points", language), justify="right", no_wrap=True)
    for assignment in assignments:
        title = Prose(visible_line(assignment.title.get(language)))
        table.add_row(assignment.id, title, quantity.points(assignment.max_score))
    return table


def _parts(assignment: Assignment, rubric: PublishedRubric, language: Language) -> Iterator[RenderableType]:
    most = quantity.points(rubric.max_score)
    title = Text.assemble(
        (visible_line(rubric.title.get(language)), "bold"), f"  {assignment.id}  ", style=""
    )
    worth = word("worth", language, points=most)
    if assignment.input != "text":  # which is read, not run
        worth += word("time_limit", language, seconds=quantity.points(rubric.horizon_s))
    if assignment.release != DEFAULT_DISTRO:  # which goes without saying
        worth += f"  ROS 2 {assignment.release.capitalize()}"
    if assignment.started_as != DEFAULT_WAY:
        worth += "  ros2 run"
    yield title.append(worth, "cyan")
    if brief := rubric.brief.get(language):
        yield Padding(Prose(visible(brief).strip()), (1, 0, 0, 0))
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column(word("item", language), ratio=1, overflow="fold")
    table.add_column(word("worth_points", language), justify="right", no_wrap=True)
    table.add_column(word("wanted", language), overflow="fold", max_width=_WANTED_COLUMNS)
    for item in rubric.items:
        table.add_row(
            _item(item, language),
            quantity.points(item.points),
            Text(visible_line(item.wanted.get(language))),
        )
    yield table
    if remarks := rubric.remarks.get(language):
        yield Prose(visible(remarks).strip(), style="dim")


def _item(item: PublishedItem, language: Language) -> Text:
    text = Prose(visible_line(item.title.get(language)))
    for line in (item.measure.get(language), item.partial.get(language), item.needs.get(language)):
        if line:
            text.append(f"\n{visible_line(line)}", style="dim")
    return text
