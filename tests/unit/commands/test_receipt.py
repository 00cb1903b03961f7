"""`grader receipt`, as typed."""

from contextlib import closing
from pathlib import Path

import pytest

from grader.commands import cli
from grader.contracts.identity import RosterEntry
from grader.contracts.receipt import UploadReceipt
from grader.contracts.submission import NewSubmission
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.receipts import Receipts
from tests.fakes.clock import FakeClock
from tests.fakes.submissions import Submissions


def test_a_receipt_is_checked_without_a_service(
    sqlite_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = FakeClock()
    with closing(Database(sqlite_url)) as database:
        courses = Courses(database, clock)
        courses.create("ros", "ROS", "UTC", "test")
        courses.import_roster("ros", [RosterEntry(id="li", name="Li")], "test")
        new = NewSubmission(
            course="ros",
            student="li",
            assignment="square",
            file_name="square.py",
            source=b"good",
            key="k",
            by="li",
        )
        submission = Submissions(database, clock).add(new)
        text = UploadReceipt.of(submission).signed(Receipts(database).key_to_sign())
    monkeypatch.setenv("GRADER_DATABASE_URL", sqlite_url)
    receipt, file = tmp_path / "receipt.txt", tmp_path / "square.py"

    def said(text: str, content: bytes) -> tuple[int, str]:
        receipt.write_text(text)
        file.write_bytes(content)
        status = cli.run(["receipt", str(receipt), "--file", str(file), "--lang", "en"])
        out, err = capsys.readouterr()
        return status, out + err

    status, told = said(text, b"good")
    assert status == 0
    assert told.splitlines()[0].startswith("ros  li  square  square.py  ")
    assert "The receipt is genuine\nThe file is the one that was handed in" in told
    status, told = said(text, b"better")
    assert (status, "The file is not the one" in told) == (1, True)
    status, told = said(text.replace("li", "lo"), b"good")
    assert (status, "not signed here" in told) == (1, True)
    receipt.unlink()
    assert cli.run(["receipt", str(receipt), "--lang", "en"]) == 2
