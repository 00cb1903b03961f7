"""A school that signs its servers' certificates itself, and one of its servers."""

import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

_KEY = ec.generate_private_key(ec.SECP256R1())
_DAY = timedelta(days=1)


def authority(folder: Path) -> Path:
    """Return the file of the school's certificate."""
    key = x509.SubjectKeyIdentifier.from_public_key(_KEY.public_key())
    made = _certificate("school").add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    made = made.add_extension(signs_certificates(), critical=True)  # from Python 3.13 on a root must have it
    path = folder / "school.pem"
    path.write_bytes(_pem(made.add_extension(key, critical=False)))
    return path


@contextmanager
def https(signer: Path, host: str) -> Iterator[str]:
    """Open a server of the school on loopback that says a word; yield its address under `host`."""
    names = x509.SubjectAlternativeName([x509.DNSName(host)])
    key = x509.AuthorityKeyIdentifier.from_issuer_public_key(_KEY.public_key())
    made = _certificate(host).add_extension(names, critical=False).add_extension(key, critical=False)
    chain = signer.with_name("server.pem")
    secret = _KEY.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    chain.write_bytes(secret + _pem(made))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(chain)
    with ThreadingHTTPServer(("127.0.0.1", 0), _Word) as server:
        server.socket = context.wrap_socket(server.socket, server_side=True)
        thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield f"https://{host}:{server.server_address[1]}/"
        finally:
            server.shutdown()
            thread.join()


class _Word(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Length", "6")
        self.end_headers()
        self.wfile.write(b"secret")

    def log_message(self, *_: object) -> None:
        """Keep silent."""


def signs_certificates() -> x509.KeyUsage:
    """Return what an authority's key is for."""
    others = ("digital_signature", "content_commitment", "key_encipherment", "data_encipherment")
    others += ("key_agreement", "crl_sign", "encipher_only", "decipher_only")
    return x509.KeyUsage(key_cert_sign=True, **dict.fromkeys(others, False))


def _certificate(name: str) -> x509.CertificateBuilder:
    now = datetime.now(UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)]))
        .issuer_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "school")]))
        .public_key(_KEY.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _DAY)
        .not_valid_after(now + _DAY)
    )


def _pem(certificate: x509.CertificateBuilder) -> bytes:
    return certificate.sign(_KEY, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)
