"""Receipts: a short text that says what was handed in and when, signed, so that it can be checked years later.

It is checked without the database that it was made from, but with the service's key.
"""

import hmac
from dataclasses import dataclass, fields

from grader.contracts.submission import Submission

_HEAD = "grader receipt 1"
_SIGNATURE = "signature"
LONGEST_RECEIPT = 4_000


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadReceipt:
    """What a receipt says.

    Attributes:
        sha256: hexadecimal digest of the bytes that are stored. received: ISO 8601, to the microsecond, in UTC.
    """

    course: str
    assignment: str
    student: str
    submission: str
    file: str
    sha256: str
    received: str

    @classmethod
    def of(cls, submission: Submission) -> "UploadReceipt":
        """Return the receipt of a submission."""
        return cls(
            course=submission.course or "",
            assignment=submission.assignment,
            student=submission.student,
            submission=submission.id,
            file=submission.file_name,
            sha256=submission.sha256,
            received=submission.received_at.isoformat(timespec="microseconds"),
        )

    def signed(self, key: bytes) -> str:
        """Return the text with the signature of `key`: HMAC-SHA256 of the lines before."""
        text = self._text()
        return f"{text}{_SIGNATURE}: {_signature(text, key)}\n"

    def _text(self) -> str:
        lines = [f"{field.name}: {getattr(self, field.name)}" for field in fields(self)]
        return "\n".join([_HEAD, *lines, ""])


def read_receipt(text: str, key: bytes) -> UploadReceipt | None:
    """Return what a receipt says if `key` signed it; None: it did not, or the text is no receipt.

    Empty lines and spaces around lines do not matter: mail programs add them.
    """
    lines = [line.strip() for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    names = [field.name for field in fields(UploadReceipt)]
    parts = [line.partition(":") for line in lines[1:]]
    if lines[:1] != [_HEAD] or [part[0] for part in parts] != [*names, _SIGNATURE]:
        return None
    *values, signature = (part[2].strip() for part in parts)
    receipt = UploadReceipt(**dict(zip(names, values, strict=True)))
    good = hmac.compare_digest(signature.lower().encode(), _signature(receipt._text(), key).encode())
    return receipt if good else None


def _signature(text: str, key: bytes) -> str:
    return hmac.new(key, text.encode(), "sha256").hexdigest()
