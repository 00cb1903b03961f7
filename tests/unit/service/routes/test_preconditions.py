"""If-Match, as RFC 9110 (section 13.1.1) wants it."""

import pytest

from grader.service.requests.dependencies import etag, seen


@pytest.mark.parametrize(
    ("header", "included"),
    [
        ('"1.ab"', True),
        (etag("1.ab"), True),
        ('"0.x", "1.ab"', True),
        ('"a,b" ,"1.ab"', True),
        ("*", True),
        (" * ", True),
        ('W/"1.ab"', False),
        ('W/"1.ab", "2.ab"', False),
        ('"2.ab"', False),
        ("1.ab", False),
        ('"*"', False),
        ("", False),
    ],
)
def test_strong_tags_lists_and_the_star(header: str, included: bool) -> None:
    states = seen(header)
    assert states is not None
    assert states.includes("1.ab") is included


def test_no_header_means_no_condition() -> None:
    assert seen(None) is None
