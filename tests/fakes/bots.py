"""Group bots on this machine that check what they are sent as their vendors' documents say."""

import base64
import hashlib
import hmac
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qsl, urlsplit

SECRET = "SECsecret-of-the-bot"
KEY = "0f5a-key-of-the-bot"
_HOUR_S = 3_600
Answer = tuple[int, dict[str, Any] | bytes]


@dataclass
class FakeBots:
    """What the bots were told.

    Attributes:
        texts: those that were taken. asked: paths of all requests, with their queries. seen: bodies of all.
        answer: takes the place of whatever a bot would answer. clock_s: the vendors' time.
    """

    address: str = ""
    texts: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)
    seen: list[dict[str, Any]] = field(default_factory=list)
    answer: Answer | None = None
    clock_s: Callable[[], float] = lambda: 0.0

    def of(self, vendor: str) -> str:
        """Return the address of a vendor's bot."""
        path = {
            "feishu": f"/open-apis/bot/v2/hook/{KEY}",
            "dingtalk": f"/robot/send?access_token={KEY}",
            "wecom": f"/cgi-bin/webhook/send?key={KEY}",
        }
        return self.address + path[vendor]

    def reply(self, path: str, body: dict[str, Any]) -> Answer:
        """Take a message, or say why not."""
        parts = urlsplit(path)
        query = dict(parse_qsl(parts.query, strict_parsing=bool(parts.query)))
        if self.answer is not None:
            return self.answer
        match parts.path:
            case "/robot/send":
                return self._dingtalk(query, body)
            case "/cgi-bin/webhook/send":
                return self._wecom(query, body)
            case _:
                return self._feishu(parts.path, body)

    def _feishu(self, path: str, body: dict[str, Any]) -> Answer:
        if path != f"/open-apis/bot/v2/hook/{KEY}":
            return 200, {
                "code": 19001,
                "data": {},
                "msg": "param invalid: incoming webhook access token invalid",
            }
        said = f"{body['timestamp']}\n{SECRET}".encode()
        wanted = base64.b64encode(hmac.new(said, b"", hashlib.sha256).digest()).decode()
        fresh = abs(self.clock_s() - int(body["timestamp"])) < _HOUR_S
        if body["sign"] != wanted or not fresh:
            return 200, {
                "code": 19021,
                "data": {},
                "msg": "sign match fail or timestamp is not within one hour from current time",
            }
        assert body["msg_type"] == "text"
        self.texts.append(body["content"]["text"])
        return 200, {"code": 0, "data": {}, "msg": "success", "StatusCode": 0, "StatusMessage": "success"}

    def _dingtalk(self, query: dict[str, str], body: dict[str, Any]) -> Answer:
        if query.get("access_token") != KEY:
            return 200, {"errcode": 300005, "errmsg": "token is not exist"}
        said = f"{query.get('timestamp')}\n{SECRET}".encode()
        wanted = base64.b64encode(hmac.new(SECRET.encode(), said, hashlib.sha256).digest()).decode()
        fresh = abs(self.clock_s() * 1000 - int(query.get("timestamp", "0"))) < _HOUR_S * 1000
        if query.get("sign") != wanted or not fresh:
            return 200, {"errcode": 310000, "errmsg": "sign not match"}
        assert body["msgtype"] == "text"
        self.texts.append(body["text"]["content"])
        return 200, {"errcode": 0, "errmsg": "ok"}

    def _wecom(self, query: dict[str, str], body: dict[str, Any]) -> Answer:
        if query != {"key": KEY}:
            return 200, {"errcode": 93000, "errmsg": "invalid webhook url, hint: [1], from ip: 127.0.0.1"}
        if len(body["text"]["content"].encode()) > 2_048:
            return 200, {"errcode": 40058, "errmsg": "text.content exceed max length 2048"}
        assert body["msgtype"] == "text"
        self.texts.append(body["text"]["content"])
        return 200, {"errcode": 0, "errmsg": "ok"}


@contextmanager
def bots() -> Iterator[FakeBots]:
    """Serve them on a free port."""
    known = FakeBots()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            content = self.rfile.read(int(self.headers["Content-Length"]))
            assert self.headers["Content-Type"] == "application/json"
            assert "Authorization" not in self.headers
            body = json.loads(content)
            known.asked.append(self.path)
            known.seen.append(body)
            status, answer = known.reply(self.path, body)
            sent = answer if isinstance(answer, bytes) else json.dumps(answer).encode()
            self.send_response(status)
            self.send_header("Content-Length", str(len(sent)))
            self.end_headers()
            self.wfile.write(sent)

        def log_message(self, *_: object) -> None:
            pass

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
