"""Sending e-mail by the operator's server: by TLS at once (``smtps``), or by STARTTLS (``smtp``)."""

import smtplib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import datetime
from email.errors import MessageError
from email.headerregistry import Address
from email.message import EmailMessage
from email.utils import format_datetime
from typing import Final
from urllib.parse import urlsplit

from grader.contracts.python import Self
from grader.operation.settings import Settings, is_loopback
from grader.outside.notices import Failure, NotSentError
from grader.outside.signin.channel import trusting

PATIENCE_S: Final = 10.0
_LONGEST_DETAIL = 200
_BUSY = (421, 450, 451, 452, 454)
_TLS, _PLAIN = "smtps", "smtp"
_PORTS = {_TLS: 465, _PLAIN: 587}


@dataclass(frozen=True, slots=True, kw_only=True)
class Letter:
    """An e-mail to one person. `id`: the same letter again has the same one, by which mailboxes know it."""

    id: str
    to: str
    heading: str
    body: str
    at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class MailChannel:
    """Sends e-mail. Safe to share between threads.

    Attributes:
        server: ``smtps://host:port`` or ``smtp://host:port``.
        user, password: with which it lets us in; empty: it asks for none.
        sender: the address that letters come from.
    """

    server: str
    sender: str
    user: str = ""
    password: str = field(default="", repr=False)

    @classmethod
    def of(cls, settings: Settings) -> Self | None:
        """Return what the operator has set up; None: nothing."""
        if not settings.mail_server:
            return None
        password = settings.mail_password
        return cls(
            server=settings.mail_server,
            sender=settings.mail_from,
            user=settings.mail_user,
            password="" if password is None else password.get_secret_value(),
        )

    def send(self, letter: Letter) -> None:
        """Send an e-mail. Raises NotSentError: the server does not answer, or does not take it."""
        message = self._message(letter)
        try:
            with self._connected() as connection:
                connection.send_message(message, self.sender, [letter.to])
        except smtplib.SMTPRecipientsRefused as error:
            status, words = error.recipients[letter.to]
            raise NotSentError(_of_letter(status), _one_line(status, words)) from None
        except smtplib.SMTPAuthenticationError as error:
            raise NotSentError("security", _one_line(error.smtp_code, error.smtp_error)) from None
        except smtplib.SMTPDataError as error:  # what other letters need not have
            raise NotSentError(
                _of_letter(error.smtp_code), _one_line(error.smtp_code, error.smtp_error)
            ) from None
        except smtplib.SMTPResponseException as error:
            raise NotSentError("refused", _one_line(error.smtp_code, error.smtp_error)) from None
        except (smtplib.SMTPException, OSError, UnicodeError) as error:
            raise NotSentError("unreachable", f"{type(error).__name__}: {error}"[:_LONGEST_DETAIL]) from None

    @contextmanager
    def _connected(self) -> Iterator[smtplib.SMTP]:
        parts = urlsplit(self.server)
        host, port = parts.hostname or "", parts.port or _PORTS[parts.scheme]
        context = trusting()
        if parts.scheme == _TLS:
            connection: smtplib.SMTP = smtplib.SMTP_SSL(host, port, timeout=PATIENCE_S, context=context)
        else:
            connection = smtplib.SMTP(host, port, timeout=PATIENCE_S)
        try:
            connection.ehlo()
            if parts.scheme == _PLAIN and not (is_loopback(host) and not connection.has_extn("starttls")):
                connection.starttls(context=context)
                connection.ehlo()
            if self.user:
                connection.login(self.user, self.password)
            yield connection
        finally:
            # Whatever it says now, it has taken the letter or not.
            with suppress(smtplib.SMTPException, OSError):
                connection.quit()
            with suppress(OSError):
                connection.close()

    def _message(self, letter: Letter) -> EmailMessage:
        message = EmailMessage()
        if not letter.to.isascii():
            raise NotSentError("recipient", "the address has letters that few servers take")
        try:
            message["From"] = Address(addr_spec=self.sender)
            message["To"] = Address(addr_spec=letter.to)
        except (ValueError, MessageError, IndexError) as error:
            raise NotSentError("recipient", f"no address: {error}"[:_LONGEST_DETAIL]) from None
        message["Subject"] = " ".join(letter.heading.split())
        message["Date"] = format_datetime(letter.at)
        message["Message-ID"] = f"<{letter.id}@{self.sender.rpartition('@')[2]}>"
        message["Auto-Submitted"] = "auto-generated"
        message.set_content(letter.body)
        return message


def _of_letter(code: int) -> Failure:
    return "refused" if code in _BUSY else "recipient"


def _one_line(code: int, words: bytes | str) -> str:
    text = words.decode(errors="replace") if isinstance(words, bytes) else words
    return f"{code} {''.join(letter if letter.isprintable() else ' ' for letter in text)}"[:_LONGEST_DETAIL]
