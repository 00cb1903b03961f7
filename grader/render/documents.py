"""Reports as documents for machines. Standard library only: imported on hot paths."""

from grader.contracts.report import GradeReport


def json_report(report: GradeReport) -> str:
    """Return the report's canonical form as text: the very bytes that its digest is taken of."""
    return report.canonical_bytes().decode()
