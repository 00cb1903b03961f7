"""OpenID Connect: authorization code with PKCE (OpenID Connect Core 1.0, 3.1; RFC 7636; RFC 9207).

The keys that sign tokens are fetched when they are needed, again after a day, and for a key id that is not among
them, at most once a minute: providers change their keys.
"""

import base64
import hashlib
import hmac
import threading
from collections.abc import Callable, Mapping
from typing import Any
from urllib.parse import quote, urlencode

import msgspec

from grader.contracts.errors import SettingsError
from grader.outside.signin.channel import UnreachableError, decoded, get, host_of, post_form
from grader.outside.signin.config import OidcEntry, secret_of
from grader.outside.signin.providers import Person, SignInAttempt, SignInError, is_subject

ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "ES256", "ES384", "EdDSA")
"""None that is made with a secret of the client's, and not ``none``."""
SKEW_S = 60
_DAY_S = 24 * 3600.0
_MINUTE_S = 60.0
_LONGEST_CLAIM = 1_000
_LATEST_S = 1e11  # of the year 5138; JSON also has numbers that no calendar has


class _Discovered(msgspec.Struct, frozen=True):
    issuer: str
    authorization_endpoint: str
    token_endpoint: str
    jwks_uri: str
    token_endpoint_auth_methods_supported: tuple[str, ...] = ("client_secret_basic",)
    authorization_response_iss_parameter_supported: bool = False


class _Granted(msgspec.Struct, frozen=True):
    id_token: str


class _Header(msgspec.Struct, frozen=True):
    alg: str
    kid: str | None = None


class KeySet:
    """The public keys behind an address, kept for a day, or until a token names one that is not there.

    So a key that its owner has withdrawn is believed for a day at most.

    Args:
        address: tells it. clock_s: the time. public_only: no address of a private network.
    """

    def __init__(
        self, address: Callable[[], str], clock_s: Callable[[], float], *, public_only: bool = False
    ) -> None:
        self._address = address
        self._public_only = public_only
        self._clock_s = clock_s
        self._lock = threading.Lock()
        self._keys: Any = None
        self._fetched_s = 0.0

    def claims(
        self, token: str, algorithms: tuple[str, ...] = ALGORITHMS, *, needs_id: bool = False
    ) -> dict[str, Any]:
        """Return what a signed token says, which must name its key if it `needs_id`.

        Raises:
            SignInError: the keys cannot be had, or none of them has signed the token by an accepted algorithm.
        """
        from joserfc import jwt
        from joserfc.errors import JoseError

        header = _header_of(token)
        if header.alg not in algorithms:
            raise SignInError("signin_failed", f"the token is signed by {header.alg[:20]}")
        if needs_id and not header.kid:
            raise SignInError("signin_failed", "the token names no key")
        try:
            read = jwt.decode(token, self._with(header.kid), algorithms=list(algorithms))
        except (JoseError, ValueError, TypeError, KeyError, RecursionError) as error:
            raise SignInError("signin_failed", f"the token: {type(error).__name__}: {error}") from None
        return dict(read.claims)

    def _with(self, kid: str | None) -> Any:
        with self._lock:
            now_s = self._clock_s()
            keys = () if self._keys is None else self._keys.keys
            missing = kid is not None and kid not in {key.kid for key in keys}
            age_s = now_s - self._fetched_s
            if self._keys is None or not 0.0 <= age_s < _DAY_S or (missing and age_s >= _MINUTE_S):
                self._keys, self._fetched_s = self._fetched(), now_s
            return self._keys

    def _fetched(self) -> Any:
        from joserfc.errors import JoseError
        from joserfc.jwk import KeySet as Keys

        try:
            document: Any = decoded(get(self._address(), public_only=self._public_only), dict[str, Any])
            return Keys.import_key_set(document)
        except UnreachableError as error:
            raise SignInError("signin_unreachable", str(error)) from None
        except (JoseError, ValueError, TypeError, KeyError) as error:
            raise SignInError("signin_failed", f"the keys cannot be read: {error}") from None


class Oidc:
    """One OpenID provider. Safe to share between threads."""

    def __init__(self, entry: OidcEntry, secret: str, clock_s: Callable[[], float]) -> None:
        self._entry = entry
        self._secret = secret
        self._clock_s = clock_s
        self._lock = threading.Lock()
        self._known: _Discovered | None = None
        self._known_since_s = 0.0
        self._keys = KeySet(lambda: self._discovered().jwks_uri, clock_s)
        self.id, self.title = entry.id, entry.title

    def login_address(self, attempt: SignInAttempt, back: str) -> str:
        """Return the address of the provider's form."""
        digest = hashlib.sha256(attempt.verifier.encode()).digest()
        query = {
            "response_type": "code",
            "client_id": self._entry.client_id,
            "redirect_uri": back,
            "scope": " ".join(self._entry.scopes),
            "state": attempt.state,
            "nonce": attempt.nonce,
            "code_challenge": base64.urlsafe_b64encode(digest).rstrip(b"=").decode(),
            "code_challenge_method": "S256",
        }
        address = self._discovered().authorization_endpoint
        return f"{address}{'&' if '?' in address else '?'}{urlencode(query)}"

    def recognised(self, attempt: SignInAttempt, back: str, answer: Mapping[str, str]) -> Person:
        """Change the code for a token and check it."""
        issuer = answer.get("iss")
        if issuer is None and self._discovered().authorization_response_iss_parameter_supported:
            raise SignInError("signin_failed", "the answer does not name its issuer (RFC 9207)")
        if issuer is not None and issuer != self._entry.issuer:
            raise SignInError("signin_failed", f"the answer is of {issuer[:200]!r}")
        code = answer.get("code")
        if not code:
            reason = f"{answer.get('error', 'no code')}: {answer.get('error_description', '')}"
            raise SignInError("signin_refused", reason[:300])
        return self._person(self._keys.claims(self._token(code, attempt, back)), attempt)

    def _discovered(self) -> _Discovered:
        with self._lock:
            now_s = self._clock_s()
            if self._known is None or not 0.0 <= now_s - self._known_since_s < _DAY_S:
                self._known, self._known_since_s = self._asked(), now_s
            return self._known

    def _asked(self) -> _Discovered:
        address = f"{self._entry.issuer.rstrip('/')}/.well-known/openid-configuration"
        try:
            discovered = decoded(get(address), _Discovered)
        except UnreachableError as error:
            raise SignInError("signin_unreachable", str(error)) from None
        except ValueError as error:
            raise SignInError("signin_unreachable", f"{address}: {error}") from None
        if discovered.issuer != self._entry.issuer:
            raise SignInError("signin_unreachable", f"{address} is of {discovered.issuer[:200]!r}")
        addresses = (
            discovered.authorization_endpoint.partition("?")[0],
            discovered.token_endpoint,
            discovered.jwks_uri,
        )
        encrypted = self._entry.issuer.startswith("https://")
        if any(host_of(one) is None or (encrypted and not one.startswith("https://")) for one in addresses):
            raise SignInError("signin_unreachable", f"{address} names an address without https://")
        return discovered

    def _token(self, code: str, attempt: SignInAttempt, back: str) -> str:
        discovered = self._discovered()
        form = {
            "grant_type": "authorization_code",
            "code": code,
            "redirect_uri": back,
            "code_verifier": attempt.verifier,
        }
        in_header = self._secret and "client_secret_basic" in discovered.token_endpoint_auth_methods_supported
        credentials = (
            (quote(self._entry.client_id, safe=""), quote(self._secret, safe="")) if in_header else None
        )
        if not in_header:
            form |= {"client_id": self._entry.client_id}
            form |= {"client_secret": self._secret} if self._secret else {}
        try:
            status, content = post_form(discovered.token_endpoint, form, credentials)
        except UnreachableError as error:
            raise SignInError("signin_unreachable", str(error)) from None
        if status != 200:
            refusal = content[:300].decode(errors="replace")
            raise SignInError("signin_refused", f"the code is not accepted: {status} {refusal}")
        try:
            return decoded(content, _Granted).id_token
        except ValueError as error:
            raise SignInError("signin_failed", f"the token endpoint's answer: {error}") from None

    def _person(self, claims: Mapping[str, Any], attempt: SignInAttempt) -> Person:
        check_token(claims, self._entry.issuer, self._entry.client_id, attempt.nonce, self._clock_s())
        entry = _text(claims.get(self._entry.claim))
        if self._entry.claim != "email":
            return Person(subject=claims["sub"], claimed=entry)
        return Person(subject=claims["sub"], email=entry if claims.get("email_verified") is True else "")


def oidc(entry: OidcEntry, clock_s: Callable[[], float]) -> Oidc:
    """Return the provider; nothing is asked yet.

    Raises SettingsError: its secret cannot be read, or what checks tokens is not installed.
    """
    try:
        import joserfc  # noqa: F401 - an extra
    except ImportError:
        raise SettingsError(
            "signin (GRADER_SIGNIN): kind = \"oidc\" needs the extra 'signin': pip install 'grader[signin]'",
            "signin (GRADER_SIGNIN)：kind = \"oidc\" 需要安装附加组件：pip install 'grader[signin]'",
        ) from None
    return Oidc(entry, secret_of(entry), clock_s)


def check_token(claims: Mapping[str, Any], issuer: str, client_id: str, nonce: str, now_s: float) -> None:
    """Check an ID token that is well signed (OpenID Connect Core 1.0, 3.1.3.7).

    Raises SignInError: it is of or for somebody else, of another time, or of another attempt.
    """
    audience = claims.get("aud")
    audiences = audience if isinstance(audience, list) else [audience]
    authorized = claims.get("azp", client_id if len(audiences) == 1 else None)
    expires, issued, subject = _instant(claims.get("exp")), _instant(claims.get("iat")), claims.get("sub")
    seen = claims.get("nonce")
    wrong = {
        "iss": claims.get("iss") != issuer,
        "aud": client_id not in audiences,
        "azp": authorized != client_id,
        "exp": expires is None or expires <= now_s - SKEW_S,
        "iat": issued is None or issued > now_s + SKEW_S,
        "nonce": not isinstance(seen, str) or not hmac.compare_digest(_bytes(seen), _bytes(nonce)),
        "sub": not isinstance(subject, str) or not is_subject(subject),
    }
    failed = [name for name, is_wrong in wrong.items() if is_wrong]
    if failed:
        raise SignInError("signin_failed", f"the token's {', '.join(failed)}")


def _bytes(text: str) -> bytes:
    return text.encode(errors="replace")  # JSON has halves of surrogate pairs


def _instant(value: object) -> float | None:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    return value if 0 <= value < _LATEST_S else None


def _text(value: object) -> str:
    if not isinstance(value, str) or len(value) > _LONGEST_CLAIM or not value.isprintable():
        return ""
    return value.strip()


def _header_of(token: str) -> _Header:
    head = token.partition(".")[0]
    try:
        return decoded(base64.urlsafe_b64decode(head + "=" * (-len(head) % 4)), _Header)
    except ValueError:
        raise SignInError("signin_failed", "the token cannot be read") from None
