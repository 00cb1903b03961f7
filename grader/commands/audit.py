"""Print what rubrics see of single edits of their solutions (`grader.grading.examination.audit`)."""

from collections.abc import Iterable
from contextlib import closing

from rich import text as styled
from rich.table import Table

from grader.catalog import Catalog
from grader.contracts.notation import written
from grader.contracts.text import Language, Text
from grader.grading.examination import OwnScript
from grader.grading.examination.audit import Audit, GradedMutant, audited
from grader.grading.slot import Slot, SlotConfig
from grader.render.progress import followed
from grader.render.terminal import console

_ASSIGNMENT = Text(zh="作业", en="assignment")
_EDITS = Text(zh="改动数", en="edits")
_ALIKE = Text(zh="动作不变", en="move alike")
_BANDS = ("100", "80-99", "50-79", "20-49", "0-19")
_UNSEEN = Text(
    zh="：动作变了，却仍是满分（没有评分项要求它？）",
    en=": moves otherwise and keeps all points (asks no item for it?)",
)
_LOST = Text(zh="：几乎丢掉全部分数（为了一处小改动？）", en=": loses nearly all points (for a detail?)")
_LONGEST = 90
_MOST_ROWS = 40


def audit(catalog: Catalog, assignment_ids: Iterable[str], language: Language, most: int) -> int:
    """Grade up to `most` edits of each solution that is a script, and print counts and the two lists; return 0."""
    audits: dict[str, Audit] = {}
    with Slot(SlotConfig()) as slot, closing(followed(list(assignment_ids))) as under_way:
        for assignment_id in under_way:
            assignment = catalog.get(assignment_id)
            file = catalog.own_file(assignment, "solution")
            if file.suffix == ".py":
                solution = OwnScript(name=file.name, source=file.read_bytes())
                audits[assignment_id] = audited(assignment, solution, slot, most)
    console().print(_counts(audits, language))
    for assignment_id, one in audits.items():
        for title, rows in ((_UNSEEN, one.unseen), (_LOST, one.lost)):
            if rows:
                console().print(styled.Text(f"\n{assignment_id}{title.get(language)}"), _rows(rows))
    return 0


def _counts(audits: dict[str, Audit], language: Language) -> Table:
    table = Table(box=None)
    for heading in (
        *(sentence.get(language) for sentence in (_ASSIGNMENT, _EDITS)),
        *_BANDS,
        _ALIKE.get(language),
    ):
        table.add_column(heading)
    for assignment_id, one in audits.items():
        alike = sum(mutant.moves_alike for mutant in one.graded)
        table.add_row(assignment_id, *map(str, (len(one.graded), *one.counts, alike)))
    return table


def _rows(graded: tuple[GradedMutant, ...]) -> Table:
    """Return one row for an edit, the first `_MOST_ROWS` of them."""
    table = Table(box=None, show_header=False)
    for mutant in graded[:_MOST_ROWS]:
        change = " ".join(mutant.mutant.change.split())[:_LONGEST]
        table.add_row(str(mutant.mutant.line), written(round(mutant.pct, 2)), styled.Text(change))
    if len(graded) > _MOST_ROWS:
        table.add_row("…", "", f"+{len(graded) - _MOST_ROWS}")
    return table
