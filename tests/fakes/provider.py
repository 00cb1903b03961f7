"""A sign-in provider on this machine: OpenID Connect and CAS, whose answers a test can spoil."""

import base64
import hashlib
import hmac
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from email.message import Message
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, parse_qsl, urlsplit

from joserfc import jws, jwt
from joserfc.jwk import KeySet, RSAKey

CLIENT, SECRET = "grader", "a client's secret: ü/+"
RSA = RSAKey.generate_key(2048, parameters={"kid": "first", "use": "sig"})
CAS_SUCCESS = """<cas:serviceResponse xmlns:cas="http://www.yale.edu/tp/cas"><cas:authenticationSuccess>
<cas:user>{user}</cas:user><cas:attributes><cas:XH>{number}</cas:XH><cas:cn>王小明</cas:cn></cas:attributes>
</cas:authenticationSuccess></cas:serviceResponse>"""
CAS_FAILURE = """<cas:serviceResponse xmlns:cas="http://www.yale.edu/tp/cas">
<cas:authenticationFailure code="INVALID_TICKET">not recognized</cas:authenticationFailure>
</cas:serviceResponse>"""


class FakeProvider:
    """What the provider knows and says. `spoil` changes an ID token's claims, `sign` how it is signed.

    Attributes:
        address: its issuer, and under ``/cas`` the CAS server.
        codes: for each code given out, what its token must be asked for with. tickets: for each, its service.
        asked: paths in the order of requests.
    """

    def __init__(self) -> None:
        self.address = ""
        self.user = "li"
        self.claims: dict[str, Any] = {}
        self.now = 0.0
        self.clock_s: Callable[[], float] = lambda: self.now
        self.keys: list[Any] = [RSA]
        self.sign: Callable[[dict[str, Any]], str] = self.signed
        self.down = False
        self.cas_answer: str | None = None
        self.codes: dict[str, dict[str, str]] = {}
        self.tickets: dict[str, str] = {}
        self.asked: list[str] = []
        self.tool_keys: dict[str, Any] = {}
        self.scores: list[dict[str, Any]] = []
        self.score_status = 200
        self.tools: list[tuple[str, dict[str, Any]]] = []
        self.configured: dict[str, Any] = {}
        self.registered: tuple[int, Any] = (200, {})
        self.people: list[Any] = [[]]  # pages of its course
        self.elsewhere = ""

    def signed(self, claims: dict[str, Any], key: Any = RSA) -> str:
        return jws.serialize_compact({"alg": "RS256", "kid": key.kid}, json.dumps(claims), key)

    def by_secret(self, claims: dict[str, Any]) -> str:
        """Sign as whoever knows the public key alone could; no library signs that way."""
        body = _parts({"alg": "HS256", "kid": "first"}, claims)
        mac = hmac.digest(RSA.as_pem(private=False), body.encode(), "sha256")
        return f"{body}.{base64.urlsafe_b64encode(mac).rstrip(b'=').decode()}"

    def unsigned(self, claims: dict[str, Any]) -> str:
        return _parts({"alg": "none"}, claims) + "."

    def authorize(self, address: str) -> dict[str, str]:
        """Be the person at the provider's form: return the fields that the browser brings back."""
        parts = urlsplit(address)
        asked = dict(parse_qsl(parts.query))
        if parts.path == "/cas/login":
            ticket = f"ST-{len(self.tickets)}-abc"
            self.tickets[ticket] = asked["service"]
            state = dict(parse_qsl(urlsplit(asked["service"]).query))["state"]
            return {"state": state, "ticket": ticket}
        assert asked["response_type"] == "code"
        assert asked["code_challenge_method"] == "S256"
        assert "openid" in asked["scope"].split()
        code = f"code-{len(self.codes)}"
        self.codes[code] = asked
        return {"state": asked["state"], "code": code, "iss": self.address}

    def token(self, form: dict[str, str], authorization: str) -> tuple[int, dict[str, Any]]:
        user, _, password = base64.b64decode(authorization.removeprefix("Basic ")).decode().partition(":")
        client = [parse_qs(f"x={one}")["x"][0] for one in (user, password)]
        asked = self.codes.pop(form.get("code", ""), None)
        digest = hashlib.sha256(form.get("code_verifier", "").encode()).digest()
        challenge = base64.urlsafe_b64encode(digest).rstrip(b"=").decode()
        if (
            asked is None
            or asked["redirect_uri"] != form["redirect_uri"]
            or asked["code_challenge"] != challenge
        ):
            return 400, {"error": "invalid_grant"}
        if client != [CLIENT, SECRET]:
            return 401, {"error": "invalid_client"}
        claims = {
            "iss": self.address,
            "aud": CLIENT,
            "sub": f"sub-of-{self.user}",
            "preferred_username": self.user,
            "nonce": asked["nonce"],
            "iat": int(self.now),
            "exp": int(self.now) + 300,
        }
        return 200, {"id_token": self.sign(claims | self.claims), "token_type": "Bearer", "access_token": "x"}

    def access_token(self, form: dict[str, str]) -> tuple[int, dict[str, Any]]:
        """Check a tool's assertion as a learning platform does."""
        decoded = jwt.decode(
            form["client_assertion"], KeySet.import_key_set(self.tool_keys), algorithms=["RS256"]
        )
        said = decoded.claims
        own = said["iss"] == said["sub"] and said["aud"] == f"{self.address}/access" and said["jti"]
        if not own or not self.clock_s() - 5 <= said["iat"] < said["exp"] <= self.clock_s() + 65:
            return 400, {"error": "invalid_client"}
        return 200, {"access_token": "t", "expires_in": 3600, "token_type": "Bearer", "scope": form["scope"]}

    def take(self, form: dict[str, Any], authorization: str, media_type: str) -> int:
        """Take a score as Moodle does: 409 unless it is later, in whole seconds, than the one before."""
        if authorization != "Bearer t" or media_type != "application/vnd.ims.lis.v1.score+json":
            return 401
        if self.score_status != 200:
            return self.score_status
        mine = [one for one in self.scores if one["userId"] == form["userId"]]
        if mine and mine[-1]["timestamp"][:19] >= form["timestamp"][:19]:
            return 409
        self.scores.append(form)
        return 200

    def members(self, query: dict[str, str], sent: Message) -> tuple[int, Any, str]:
        """Return a page of who is in its course, and the header Link."""
        if sent["Authorization"] != "Bearer t" or not sent["Accept"].startswith(
            "application/vnd.ims.lti-nrps.v2"
        ):
            return 401, {}, ""
        page = int(query.get("page", "0"))
        following = f"{self.elsewhere or self.address}/people?type=1&page={page + 1}"
        links = f'<{self.address}>; rel="first", <{following}>; rel="next"'
        return 200, {"id": "x", "members": self.people[page]}, links if page + 1 < len(self.people) else ""

    def configuration(self) -> dict[str, Any]:
        """Return what a learning platform tells tools that register; `configured` changes it."""
        places = ("authorization", "registration", "token")
        said = {f"{one}_endpoint": f"{self.address}/{one}" for one in places}
        family = {"product_family_code": "moodle"}
        said |= {"issuer": self.address, "jwks_uri": f"{self.address}/keys"}
        said |= {"https://purl.imsglobal.org/spec/lti-platform-configuration": family}
        return {name: value for name, value in (said | self.configured).items() if value is not None}

    def cas(self, query: dict[str, str]) -> str:
        if self.cas_answer is not None:
            return self.cas_answer
        if self.tickets.pop(query.get("ticket", ""), None) != query.get("service"):
            return CAS_FAILURE
        return CAS_SUCCESS.format(user=f"u-{self.user}", number=self.user)


def _parts(*documents: dict[str, Any]) -> str:
    encoded = (base64.urlsafe_b64encode(json.dumps(one).encode()).rstrip(b"=") for one in documents)
    return ".".join(one.decode() for one in encoded)


@contextmanager
def provider() -> Iterator[FakeProvider]:
    """Serve one on a free port."""
    known = FakeProvider()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            parts = urlsplit(self.path)
            known.asked.append(parts.path)
            if known.down:
                self._say(500, b"")
            elif parts.path == "/.well-known/openid-configuration":
                self._json(
                    200,
                    {
                        "issuer": known.address,
                        "authorization_endpoint": f"{known.address}/auth",
                        "token_endpoint": f"{known.address}/token",
                        "jwks_uri": f"{known.address}/keys",
                    },
                )
            elif parts.path == "/lti-configuration":
                self._json(200, known.configuration())
            elif parts.path == "/people":
                status, document, links = known.members(dict(parse_qsl(parts.query)), self.headers)
                self._say(status, json.dumps(document).encode(), links)
            elif parts.path == "/keys":
                self._json(200, KeySet(known.keys).as_dict(private=False))
            elif parts.path in ("/cas/p3/serviceValidate", "/cas/serviceValidate"):
                self._say(200, known.cas(dict(parse_qsl(parts.query))).encode())
            else:
                self._say(404, b"")

        def do_POST(self) -> None:
            known.asked.append(self.path)
            body = self.rfile.read(int(self.headers["Content-Length"]))
            authorization, media_type = (
                self.headers.get(one, "") for one in ("Authorization", "Content-Type")
            )
            form = dict(parse_qsl(body.decode(errors="replace")))
            if known.down:
                self._say(503, b"")
            elif self.path == "/items/7/scores?type_id=1":
                self._say(known.take(json.loads(body), authorization, media_type), b"")
            elif self.path == "/registration":
                known.tools.append((authorization, json.loads(body)))
                self._json(*known.registered)
            elif self.path == "/access":
                self._json(*known.access_token(form))
            else:
                self._json(*known.token(form, authorization))

        def _json(self, status: int, document: dict[str, Any] | bytes) -> None:
            self._say(status, document if isinstance(document, bytes) else json.dumps(document).encode())

        def _say(self, status: int, content: bytes, links: str = "") -> None:
            self.send_response(status)
            if links:
                self.send_header("Link", links)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, format: str, *args: object) -> None:
            """Keep quiet."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    known.address = f"http://127.0.0.1:{server.server_port}"
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield known
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
