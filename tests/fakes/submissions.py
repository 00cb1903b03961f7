"""Submissions of a database, to which a test adds some."""

from grader.contracts.submission import NewSubmission, Submission
from grader.store.clock import Clock
from grader.store.database import Database
from grader.store.intake import Intake
from grader.store.submissions import Submissions as StoredSubmissions


class Submissions(StoredSubmissions):
    """Those that are stored, and their intake."""

    def __init__(self, database: Database, clock: Clock) -> None:
        super().__init__(database)
        self._intake, self._clock = Intake(database), clock

    def accept(self, upload: NewSubmission) -> tuple[Submission, bool]:
        return self._intake.accept(upload, self._clock())

    def add(self, upload: NewSubmission) -> Submission:
        return self.accept(upload)[0]
