"""Single edits of a solution, graded: the same ones each time, and what they say of the rubric."""

from grader.contracts.grading import Grader
from grader.grading.examination import OwnScript
from grader.grading.examination.audit import audited
from tests.e2e.grading_slot import catalog


def test_an_audit_counts_each_edit_once_and_lists_what_a_person_reads(grader: Grader) -> None:
    task = catalog().get("straight")
    file = catalog().own_file(task, "solution")
    solution = OwnScript(name=file.name, source=file.read_bytes())
    audit = audited(task, solution, grader, most=12)
    assert len(audit.graded) == sum(audit.counts) == 12
    assert all(one.pct == 100.0 and not one.moves_alike for one in audit.unseen)
    assert all(one.pct <= 5.0 and one.ran for one in audit.lost)
    assert audit == audited(task, solution, grader, most=12)
