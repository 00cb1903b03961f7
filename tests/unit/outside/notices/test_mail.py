"""E-mail by a server of the operator's: encrypted, with a login, and every refusal noticed."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest

from grader.operation.settings import Settings
from grader.outside.notices import NotSentError
from grader.outside.notices.mail import Letter, MailChannel
from tests.fakes.mailbox import PASSWORD, USER, Mailbox, certificate, mailbox

AT = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
LETTER = Letter(
    id="a1", to="li@example.edu", heading="【ROS】已批改", body="走正方形：计入 85 / 100 分\n", at=AT
)


@pytest.fixture(scope="module")
def pem(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return certificate(tmp_path_factory.mktemp("mail"))


@pytest.fixture
def trusted(pem: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SSL_CERT_FILE", str(pem))


@pytest.fixture
def starting(pem: Path) -> Iterator[Mailbox]:
    with mailbox(pem, tls_at_once=False) as known:
        yield known


@pytest.fixture
def encrypted(pem: Path) -> Iterator[Mailbox]:
    with mailbox(pem, tls_at_once=True) as known:
        yield known


def channel(box: Mailbox, scheme: str = "smtp", **changed: str) -> MailChannel:
    server = f"{scheme}://localhost:{box.port}"
    said = {"server": server, "sender": "grader@example.edu", "user": USER, "password": PASSWORD}
    return MailChannel(**(said | changed))


def failure(send: Callable[[], None]) -> NotSentError:
    with pytest.raises(NotSentError) as told:
        send()
    assert PASSWORD not in str(told.value)
    return told.value


@pytest.mark.parametrize("scheme", ["smtp", "smtps"])
def test_a_letter_arrives_as_it_was_written(
    request: pytest.FixtureRequest, trusted: None, scheme: str
) -> None:
    box = request.getfixturevalue("encrypted" if scheme == "smtps" else "starting")
    channel(box, scheme).send(LETTER)
    ((sender, recipients, message),) = box.letters
    assert box.encrypted == [True]
    assert (sender, recipients) == ("grader@example.edu", ["li@example.edu"])
    assert (message["From"], message["To"]) == ("grader@example.edu", "li@example.edu")
    assert (message["Subject"], message["Message-ID"]) == ("【ROS】已批改", "<a1@example.edu>")
    assert message["Date"].datetime == AT
    assert message["Auto-Submitted"] == "auto-generated"
    assert message.get_content() == LETTER.body


@pytest.mark.parametrize("scheme", ["smtp", "smtps"])
def test_a_certificate_that_nobody_vouches_for_is_refused(
    request: pytest.FixtureRequest, scheme: str
) -> None:
    box = request.getfixturevalue("encrypted" if scheme == "smtps" else "starting")
    assert failure(lambda: channel(box, scheme).send(LETTER)).code == "unreachable"
    assert box.letters == []


def test_a_wrong_password_is_said(starting: Mailbox, trusted: None) -> None:
    told = failure(lambda: channel(starting, password="other").send(LETTER))
    assert (told.code, told.detail[:3]) == ("security", "535")


def test_without_encryption_no_password_is_sent(starting: Mailbox) -> None:
    """A server of this machine may do without; one that wants a login then gets none."""
    starting.offers_tls = False
    told = failure(lambda: channel(starting).send(LETTER))
    assert (told.code, starting.letters) == ("unreachable", [])
    starting.asks_login = False
    channel(starting, user="", password="").send(LETTER)
    assert starting.encrypted == [False]


def test_another_machine_must_encrypt(starting: Mailbox, monkeypatch: pytest.MonkeyPatch) -> None:
    starting.offers_tls = starting.asks_login = False
    monkeypatch.setattr("grader.outside.notices.mail.is_loopback", lambda _: False)
    told = failure(lambda: channel(starting, user="", password="").send(LETTER))
    assert ("STARTTLS" in told.detail, starting.letters) == (True, [])


def test_refusals_of_one_letter_and_of_all(starting: Mailbox, trusted: None) -> None:
    starting.refused = {"li@example.edu": "550 5.1.1 no such user"}
    told = failure(lambda: channel(starting).send(LETTER))
    assert (told.code, told.is_persons, told.detail) == ("recipient", True, "550 5.1.1 no such user")
    starting.refused = {"li@example.edu": "451 4.7.1 try again later"}
    assert failure(lambda: channel(starting).send(LETTER)).code == "refused"
    starting.refused, starting.refusal = {}, "554 5.7.1 looks like spam"
    assert failure(lambda: channel(starting).send(LETTER)).code == "recipient"
    starting.refusal = "452 4.3.1 mailbox full"
    assert failure(lambda: channel(starting).send(LETTER)).code == "refused"
    assert starting.letters == []


@pytest.mark.parametrize("farewell", ["421 4.4.2 closing", "500 what?", "no number", "221 " + "x" * 9_000])
def test_a_letter_that_was_taken_is_sent_whatever_the_server_says_then(
    starting: Mailbox, trusted: None, farewell: str
) -> None:
    starting.farewell = farewell
    channel(starting).send(LETTER)
    assert len(starting.letters) == 1
    starting.refused = {"li@example.edu": "550 5.1.1 no such user"}
    assert failure(lambda: channel(starting).send(LETTER)).code == "recipient"


def test_nobody_there_is_a_failure() -> None:
    nowhere = MailChannel(server="smtp://localhost:9", sender="grader@example.edu")
    assert failure(lambda: nowhere.send(LETTER)).code == "unreachable"


@pytest.mark.parametrize("to", ["a@b,c@d", "a@b\nBcc: c@d", "李@example.edu", "<a@b>", "a@"])
def test_what_is_not_one_address_gets_nothing(starting: Mailbox, trusted: None, to: str) -> None:
    letter = Letter(id="a1", to=to, heading="x", body="x", at=AT)
    assert failure(lambda: channel(starting).send(letter)).code == "recipient"
    assert starting.letters == []


def test_a_heading_of_several_lines_adds_no_header(starting: Mailbox, trusted: None) -> None:
    letter = Letter(id="a1", to="li@example.edu", heading="x\r\nBcc: c@d", body=".\n..\nx\n", at=AT)
    channel(starting).send(letter)
    ((_, recipients, message),) = starting.letters
    assert (recipients, message["Bcc"], message["Subject"]) == (["li@example.edu"], None, "x Bcc: c@d")
    assert message.get_content() == ".\n..\nx\n"


def test_what_the_operator_says_is_what_is_used() -> None:
    assert MailChannel.of(Settings()) is None
    said = {"mail_server": "smtps://mail.example.edu", "mail_from": "grader@example.edu"}
    made = MailChannel.of(Settings(**said, mail_user="u", mail_password="secret"))
    assert made == MailChannel(
        server="smtps://mail.example.edu", sender="grader@example.edu", user="u", password="secret"
    )
    assert "secret" not in repr(made)
