"""Speaking in group chats: webhooks of the bots of Feishu, DingTalk and WeCom, signed as each documents it.

Feishu's key is the time in seconds, a newline and the secret; it signs an empty text, in the body. DingTalk's key
is the secret; it signs the time in milliseconds, a newline and the secret, in the address. Both are HMAC-SHA256 in
Base64, good for an hour. WeCom's key stands in the address. All three answer what they refuse with
status 200 and an error code.
"""

import base64
import hmac
from collections.abc import Callable
from typing import Any, Final
from urllib.parse import parse_qs, quote_plus, urlsplit

import msgspec

from grader.contracts.notice import NewWebhook, Vendor
from grader.outside.notices import Failure, NotSentError
from grader.outside.signin.channel import UnreachableError, decoded, is_confidential, post_json

MOST_BYTES: Final = 2_000
"""Of a message: WeCom takes 2,048."""

_LONGEST_DETAIL = 200
_TOO_MANY_REQUESTS = 429
_PATHS = {
    Vendor.FEISHU: "/open-apis/bot/v2/hook/",
    Vendor.DINGTALK: "/robot/send",
    Vendor.WECOM: "/cgi-bin/webhook/send",
}
_KEYS = {Vendor.DINGTALK: "access_token", Vendor.WECOM: "key"}
_FAILURES: dict[tuple[Vendor, int], Failure] = {
    (Vendor.FEISHU, 19001): "address",
    (Vendor.FEISHU, 19021): "security",
    (Vendor.FEISHU, 19022): "security",
    (Vendor.FEISHU, 19024): "security",
    (Vendor.FEISHU, 11232): "too_often",
    (Vendor.FEISHU, 99991400): "too_often",
    (Vendor.DINGTALK, 300001): "address",
    (Vendor.DINGTALK, 300005): "address",
    (Vendor.DINGTALK, 310000): "security",
    (Vendor.DINGTALK, 130101): "too_often",
    (Vendor.DINGTALK, 410100): "too_often",
    (Vendor.WECOM, 93000): "address",
    (Vendor.WECOM, 93008): "address",
    (Vendor.WECOM, 45009): "too_often",
}
"""Vendors' error codes that somebody can act on, each with its meaning."""


class _Answer(msgspec.Struct, frozen=True):
    """What a bot answers: Feishu's has ``code``, or ``StatusCode``; the others have ``errcode``."""

    code: int | None = None
    errcode: int | None = None
    old_code: int | None = msgspec.field(default=None, name="StatusCode")
    msg: str = ""
    errmsg: str = ""
    old_msg: str = msgspec.field(default="", name="StatusMessage")


def example_address(vendor: Vendor) -> str:
    """Return what addresses of such webhooks look like, for people."""
    hosts = {
        Vendor.FEISHU: "open.feishu.cn",
        Vendor.DINGTALK: "oapi.dingtalk.com",
        Vendor.WECOM: "qyapi.weixin.qq.com",
    }
    ends = {Vendor.FEISHU: "…", Vendor.DINGTALK: "?access_token=…", Vendor.WECOM: "?key=…"}
    return f"https://{hosts[vendor]}{_PATHS[vendor]}{ends[vendor]}"


def is_address(vendor: Vendor, address: str) -> bool:
    """Return whether a webhook of `vendor` can have this address; where it leads is looked at when sending."""
    if not is_confidential(address):
        return False
    parts = urlsplit(address)
    if parts.fragment:
        return False
    if vendor is Vendor.FEISHU:
        key = parts.path.removeprefix(_PATHS[vendor])
        return parts.path.startswith(_PATHS[vendor]) and bool(key) and "/" not in key and not parts.query
    fields = parse_qs(parts.query)
    return parts.path == _PATHS[vendor] and list(fields) == [_KEYS[vendor]]


class BotChannel:
    """Sends messages to group chats. Safe to share between threads.

    Args:
        clock_s: the time, which is part of signatures.
        private: whether webhooks may be in a private network.
    """

    def __init__(self, clock_s: Callable[[], float], *, private: bool) -> None:
        self._clock_s = clock_s
        self._private = private

    def send(self, webhook: NewWebhook, text: str) -> None:
        """Send a message. Raises NotSentError: the bot does not answer, or refuses the message."""
        address, body = _signed(webhook, _bounded(text), self._clock_s())
        content = msgspec.json.encode(body)
        shown = urlsplit(webhook.address).netloc
        try:
            status, answer = post_json(
                address, content, "application/json", public_only=not self._private, shown=shown
            )
        except UnreachableError as error:
            raise NotSentError("unreachable", str(error)) from None
        _require_accepted(webhook.vendor, status, answer)


def _signed(webhook: NewWebhook, text: str, now_s: float) -> tuple[str, dict[str, Any]]:
    """Return the address that a message is sent to, and the body that is sent."""
    if webhook.vendor is Vendor.FEISHU:
        body: dict[str, Any] = {"msg_type": "text", "content": {"text": text}}
        if webhook.secret:
            at = str(int(now_s))
            body |= {"timestamp": at, "sign": _mac(f"{at}\n{webhook.secret}", "")}
        return webhook.address, body
    body = {"msgtype": "text", "text": {"content": text}}
    if not webhook.secret or webhook.vendor is Vendor.WECOM:
        return webhook.address, body
    at = str(int(now_s * 1000))
    sign = quote_plus(_mac(webhook.secret, f"{at}\n{webhook.secret}"))
    return f"{webhook.address}&timestamp={at}&sign={sign}", body


def _mac(key: str, text: str) -> str:
    return base64.b64encode(hmac.digest(key.encode(), text.encode(), "sha256")).decode()


def _bounded(text: str) -> str:
    """Return a text, shortened between characters to the length that every vendor accepts."""
    encoded = text.encode()
    if len(encoded) <= MOST_BYTES:
        return text
    return encoded[: MOST_BYTES - 3].decode(errors="ignore") + "…"


def _require_accepted(vendor: Vendor, status: int, content: bytes) -> None:
    try:
        answer = decoded(content, _Answer)
    except ValueError:
        answer = _Answer()
    codes = (answer.code, answer.errcode, answer.old_code)
    code = next((one for one in codes if one is not None), None)
    if code == 0 and status == 200:
        return
    message = answer.msg or answer.errmsg or answer.old_msg
    printable = "".join(character for character in message if character.isprintable())
    detail = f"{status}, {code}: {printable}"[:_LONGEST_DETAIL]
    if status == _TOO_MANY_REQUESTS:
        raise NotSentError("too_often", detail)
    if code is None:
        raise NotSentError("refused", f"{status}, without a code as a bot's answer has it")
    raise NotSentError(_FAILURES.get((vendor, code), "refused"), detail)
