"""A mail server on this machine: SMTP (RFC 5321) with STARTTLS or TLS from the first byte, and a login."""

import base64
import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from email import message_from_bytes
from email.message import EmailMessage
from email.policy import default
from ipaddress import ip_address
from pathlib import Path
from socketserver import StreamRequestHandler, ThreadingTCPServer
from threading import Thread

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

USER, PASSWORD = "grader", "a password: 7!"


@dataclass
class Mailbox:
    """What the server took, and how it behaves.

    Attributes:
        letters: sender, recipients and message of each. encrypted: whether each came over TLS.
        refused: by recipient the answer to it. refusal: answer to every message. offers_tls: by STARTTLS.
        farewell: answer to who goes.
    """

    port: int = 0
    letters: list[tuple[str, list[str], EmailMessage]] = field(default_factory=list)
    encrypted: list[bool] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    refusal: str = ""
    farewell: str = "221 bye"
    offers_tls: bool = True
    asks_login: bool = True


def certificate(folder: Path) -> Path:
    """Write a certificate of this machine and its key into one file."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "localhost")])
    now = datetime.now(UTC)
    names = x509.SubjectAlternativeName([x509.DNSName("localhost"), x509.IPAddress(ip_address("127.0.0.1"))])
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=1))
        .add_extension(names, critical=False)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .sign(key, hashes.SHA256())
    )
    kept = folder / "mail.pem"
    pem = serialization.Encoding.PEM
    secret = key.private_bytes(pem, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
    kept.write_bytes(secret + made.public_bytes(pem))
    return kept


def _unstuffed(line: bytes) -> bytes:
    return line[1:] if line.startswith(b"..") else line


@contextmanager
def mailbox(pem: Path, *, tls_at_once: bool) -> Iterator[Mailbox]:
    """Serve one on a free port."""
    known = Mailbox()
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.load_cert_chain(pem)

    class Handler(StreamRequestHandler):
        disable_nagle_algorithm = True  # else the second line of an answer waits 40 ms for the client's word

        def handle(self) -> None:
            self.encrypted = self.allowed = False
            try:
                if tls_at_once:
                    self._encrypt()
                self._talk()
            except OSError:
                pass  # who does not trust the certificate goes away
            finally:
                for one in (self.rfile, self.wfile, self.connection):
                    one.close()

        def _encrypt(self) -> None:
            self.rfile.close()
            self.wfile.close()
            self.connection = context.wrap_socket(self.connection, server_side=True)
            self.rfile, self.wfile = self.connection.makefile("rb"), self.connection.makefile("wb", 0)
            self.encrypted = True

        def _say(self, text: str) -> None:
            self.wfile.write(text.encode() + b"\r\n")

        def _talk(self) -> None:
            self._say("220 localhost ESMTP")
            sender, recipients = "", []
            while line := self.rfile.readline().decode().rstrip("\r\n"):
                verb, _, rest = line.partition(" ")
                match verb.upper():
                    case "EHLO":
                        offered = [] if self.encrypted or not known.offers_tls else ["STARTTLS"]
                        offered += ["AUTH PLAIN"] if self.encrypted and known.asks_login else []
                        for one in ("localhost", *offered):
                            self._say(f"250-{one}")
                        self._say("250 8BITMIME")
                    case "STARTTLS":
                        self._say("220 go on")
                        self._encrypt()
                    case "AUTH":
                        said = base64.b64decode(rest.removeprefix("PLAIN ")).decode().split("\0")
                        self.allowed = self.encrypted and said == ["", USER, PASSWORD]
                        self._say("235 welcome" if self.allowed else "535 5.7.8 wrong name or password")
                    case "MAIL" if known.asks_login and not self.allowed:
                        self._say("530 5.7.0 authentication required")
                    case "MAIL":
                        sender, recipients = rest.partition("<")[2].partition(">")[0], []
                        self._say("250 ok")
                    case "RCPT":
                        address = rest.partition("<")[2].partition(">")[0]
                        recipients.append(address)
                        self._say(known.refused.get(address, "250 ok"))
                    case "DATA":
                        self._say("354 end with a dot")
                        content = b"".join(map(_unstuffed, iter(self.rfile.readline, b".\r\n")))
                        if known.refusal:
                            self._say(known.refusal)
                            continue
                        message = message_from_bytes(content.replace(b"\r\n", b"\n"), policy=default)
                        known.letters.append((sender, recipients, message))
                        known.encrypted.append(self.encrypted)
                        self._say("250 taken")
                    case "QUIT":
                        self._say(known.farewell)
                        return
                    case _:
                        self._say("250 ok")

    class Server(ThreadingTCPServer):
        daemon_threads = True
        allow_reuse_address = True

    server = Server(("127.0.0.1", 0), Handler)
    known.port = server.server_address[1]
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield known
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
