"""The header If-Match: a change holds only for a state that its sender has seen (RFC 9110, section 13.1.1)."""

import re

from grader.contracts.seen import Seen

_TAG = re.compile(r'(W/)?"([\x21\x23-\x7e\x80-\xff]*)"')  # RFC 9110, section 8.8.3


def seen(if_match: str | None) -> Seen | None:
    """Return which states a request is meant for; None without the header.

    Tags are compared strongly: weak ones (``W/"…"``) name no state, and neither does what is no tag.
    """
    if if_match is None:
        return None
    if if_match.strip() == "*":
        return Seen(None)
    return Seen(frozenset(tag for weak, tag in _TAG.findall(if_match) if not weak))


def etag(tag: str) -> str:
    """Return the strong ETag of the state named `tag`."""
    return f'"{tag}"'
