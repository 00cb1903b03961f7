from grader.contracts.grading import GradingJob
from grader.service.web.comparison import compare
from tests.fakes.grading import assignment, grade


def report(source: bytes):
    return grade(GradingJob(file_name="a.py", source=source, assignment=assignment())).report


def test_changes_are_in_points() -> None:
    both = compare(report(b"good"), report(b"good good"), "a\n", "a\nb\n", "en")
    assert [(pair.title, pair.change) for pair in both.items] == [("Sides", 0.0), ("Back at the start", 5.0)]
    assert [(line.kind, line.text) for line in both.diff or ()][-1] == ("added", "+b")


def test_equal_files_have_no_diff() -> None:
    assert compare(report(b""), report(b""), "a", "a", "zh").diff == ()


def test_long_files_are_not_compared_line_by_line() -> None:
    assert compare(report(b""), report(b""), "a\n" * 1_001, "a", "zh").diff is None
