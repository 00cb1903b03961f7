"""Mistakes that only several runs of one script show."""

from collections.abc import Sequence

from grader.checks.measure import Findings, Mistake, mistake
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run


def ignored_input(
    assignment: Assignment,
    runs: Sequence[Run],
    seen: Sequence[Findings],
) -> Mistake | None:
    """Recognise a script that drives the same wrong sides in every run, whatever it is given."""
    given = {case.id: (case.stdin, case.args) for case in assignment.cases}
    if len({given.get(run.case) for run in runs}) < 2 or any(len(each.mistakes) > 1 for each in seen):
        return None
    wrong = [each.mistakes[0] for each in seen if each.mistakes]
    if {each.code for each in wrong} != {"wrong_lengths"}:
        return None
    lengths = {str(each.measures["side_error_pct"].details.get("lengths")) for each in seen}
    if len(lengths) > 1:
        return None
    code = "argument_ignored" if any(args for _, args in given.values()) else "input_ignored"
    shown = seen[0].measures["side_error_pct"].details.get("lengths", "")
    return mistake(code, ("side_error_pct", "gap_pct"), lengths=shown)
