"""Receipts as texts: whatever is changed of one is noticed."""

import pytest

from grader.contracts.receipt import UploadReceipt, read_receipt

KEY = bytes(range(32))
RECEIPT = UploadReceipt(
    course="ros",
    assignment="square",
    student="20260101",
    submission="0198c2a0-0000-7000-8000-000000000001",
    file="my: 正方形.py",
    sha256="ab" * 32,
    received="2026-03-20T15:59:59.000001+00:00",
)
TEXT = RECEIPT.signed(KEY)


def test_a_receipt_is_nine_lines_with_a_signature() -> None:
    lines = TEXT.splitlines()
    assert lines[0] == "grader receipt 1"
    assert lines[6] == f"sha256: {'ab' * 32}"
    assert (
        lines[-1] == "signature: 9350ef8003d617441e1c0ee296dce2159926e7e7994066db179f96535798c123"
    )  # as openssl signs it


@pytest.mark.parametrize("sent", [TEXT, TEXT.replace("\n", "\r\n\r\n  "), "\ufeff" + TEXT.rstrip()])
def test_what_a_mail_program_does_to_it_does_not_matter(sent: str) -> None:
    assert read_receipt(sent, KEY) == RECEIPT


@pytest.mark.parametrize(
    ("old", "new"), [("2026-03-20", "2026-03-19"), ("20260101", "20260102"), ("ab", "cd")]
)
def test_a_changed_one_is_none(old: str, new: str) -> None:
    assert read_receipt(TEXT.replace(old, new), KEY) is None


@pytest.mark.parametrize(
    "text", ["", "x", TEXT.replace("student", "person"), TEXT + "more: 1\n", TEXT + TEXT]
)
def test_what_is_no_receipt_is_none(text: str) -> None:
    assert read_receipt(text, KEY) is None
    assert read_receipt(TEXT, bytes(32)) is None
