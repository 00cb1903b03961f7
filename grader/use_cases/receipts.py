"""Receipts: given for each submission, and checked, above all after an older backup was restored."""

import hashlib
from dataclasses import dataclass, replace

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.receipt import UploadReceipt, read_receipt
from grader.store.submissions import Submissions
from grader.use_cases.callers import require_staff
from grader.use_cases.services import Services
from grader.use_cases.visibility import visible_submission


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedReceipt:
    """A genuine receipt of the caller's course.

    Attributes:
        stored: the submission is still there, as the receipt says.
        same_file: whether a file that came with it is the one that was handed in; None: none came.
    """

    receipt: UploadReceipt
    stored: bool
    same_file: bool | None


def receipt_of(services: Services, caller: Caller, submission_id: str) -> str:
    """Return the signed receipt of a submission.

    Raises RefusedError: there is no such submission, or the caller does not see it.
    """
    return UploadReceipt.of(visible_submission(services, caller, submission_id)).signed(
        services.receipts.key_to_sign()
    )


def check_receipt(services: Services, caller: Caller, text: str, file: bytes) -> CheckedReceipt:
    """Return what a receipt says, and whether the file that came with it, unless it is empty, is the one.

    For staff.

    Raises:
        RefusedError: the caller may not see the class; or ``false_receipt``: this service did not sign it, or not
            for this course.
    """
    require_staff(caller)
    found = checked(services.receipts.key(), services.submissions, text, file)
    if found is None or found.receipt.course != (caller.course or ""):
        raise RefusedError("false_receipt", field="receipt")
    return found


def checked(key: bytes | None, submissions: Submissions, text: str, file: bytes) -> CheckedReceipt | None:
    """Return what a receipt of any course says, as `check_receipt`; None: `key` did not sign it."""
    receipt = None if key is None else read_receipt(text, key)
    if receipt is None:
        return None
    row = submissions.get(receipt.submission)
    # the student may have got another id since
    stored = None if row is None else replace(UploadReceipt.of(row), student=receipt.student)
    return CheckedReceipt(
        receipt=receipt,
        stored=stored == receipt,
        same_file=hashlib.sha256(file).hexdigest() == receipt.sha256 if file else None,
    )
