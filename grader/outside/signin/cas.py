"""CAS, versions 2 and 3 (apereo.github.io/cas, "CAS Protocol 3.0 Specification", 2.1 to 2.6).

The browser comes back with a ticket, which is worth something once and only together with the very address that
it was made for. That address carries the attempt's state, so nobody can be sent back with somebody else's ticket.
"""

import logging
import re
from collections.abc import Mapping
from urllib.parse import urlencode
from xml.etree import ElementTree as Xml

from grader.outside.signin.channel import UnreachableError, get
from grader.outside.signin.config import CasEntry
from grader.outside.signin.providers import Person, SignInAttempt, SignInError, is_subject

_log = logging.getLogger(__name__)
_NAMESPACE = "{http://www.yale.edu/tp/cas}"
_TICKET = re.compile(r"[A-Za-z0-9._~-]{4,512}")
_MOST_BYTES = 64 * 1024
_PATHS = {2: "/serviceValidate", 3: "/p3/serviceValidate"}


class Cas:
    """One CAS server."""

    def __init__(self, entry: CasEntry) -> None:
        self._entry = entry
        self.id, self.title = entry.id, entry.title

    def login_address(self, attempt: SignInAttempt, back: str) -> str:
        """Return the address of the server's form."""
        return f"{self._entry.url}/login?{urlencode({'service': _service(attempt, back)})}"

    def recognised(self, attempt: SignInAttempt, back: str, answer: Mapping[str, str]) -> Person:
        """Ask the server whose ticket it is."""
        ticket = answer.get("ticket", "")
        if not _TICKET.fullmatch(ticket):
            raise SignInError("signin_refused", "came back without a ticket")
        query = {"service": _service(attempt, back), "ticket": ticket}
        try:
            content = get(f"{self._entry.url}{_PATHS[self._entry.version]}", query)
        except UnreachableError as error:
            raise SignInError("signin_unreachable", str(error)) from None
        return self._person(content)

    def _person(self, content: bytes) -> Person:
        success = _success(content)
        user = (success.findtext(f"{_NAMESPACE}user") or "").strip()
        if not is_subject(user):
            raise SignInError("signin_failed", "the answer names no user")
        name = self._entry.attribute
        if not name:
            return Person(subject=user, claimed=user)
        ids = [
            (attribute.text or "").strip()
            for attribute in success.iterfind(f"{_NAMESPACE}attributes/*")
            if attribute.tag.removeprefix(_NAMESPACE) == name
        ]
        if len(ids) != 1:
            _log.warning("CAS %s: %d attributes %s of a user, not one", self.id, len(ids), name)
        return Person(subject=user, claimed=ids[0] if len(ids) == 1 else "")


def _service(attempt: SignInAttempt, back: str) -> str:
    return f"{back}?{urlencode({'state': attempt.state})}"


def _success(content: bytes) -> Xml.Element:
    # no document type, so no entities either; in UTF-16, which no server answers in, one would look otherwise
    if len(content) > _MOST_BYTES or b"<!" in content or b"\0" in content:
        raise SignInError("signin_failed", "the answer is too long or has a document type")
    try:
        root = Xml.fromstring(content)  # noqa: S314 - entities need a document type, which is refused
    except Xml.ParseError as error:
        raise SignInError("signin_failed", f"the answer is no XML: {error}") from None
    failure = root.find(f"{_NAMESPACE}authenticationFailure")
    if failure is not None:
        raise SignInError("signin_refused", f"{failure.get('code')}: {(failure.text or '').strip()[:200]}")
    success = root.find(f"{_NAMESPACE}authenticationSuccess")
    if root.tag != f"{_NAMESPACE}serviceResponse" or success is None:
        raise SignInError("signin_failed", "the answer is no cas:serviceResponse")
    return success
