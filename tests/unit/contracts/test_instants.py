from datetime import UTC, datetime, timedelta

import pytest

from grader.contracts.instants import instant

PLAIN = datetime(2026, 3, 20, 23, 59)


@pytest.mark.parametrize("text", ["2026-03-20T23:59", "2026-03-20 23:59:00", "2026-03-20t23:59:00.000000"])
def test_without_an_offset(text: str) -> None:
    assert instant(text) == PLAIN


def test_with_an_offset() -> None:
    assert instant("2026-03-20T23:59:00Z") == PLAIN.replace(tzinfo=UTC)
    assert instant("2026-03-20T23:59+08:00").utcoffset() == timedelta(hours=8)


@pytest.mark.parametrize(
    "text",
    [
        *(
            "",
            "tomorrow",
            "2026-03-20",
            "20260320T2359",
            "2026-W12-5T23:59",
            "1772409600",
            "2026-02-30T23:59",
        ),
        *(
            "2026-03-20T24:30",
            "2026-03-20T2_:59",
            "２０２６-03-20T23:59",
            " 2026-03-20T23:59",
            "2026-03-20T23:59 CST",
        ),
    ],
)
def test_what_is_no_instant(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        instant(text)
