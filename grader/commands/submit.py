"""`grader submit FILE --server URL`: hand a file in, follow its way, show the table that `grader check` shows."""

import argparse
import codecs
import os
import sys
import time
import uuid
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
from rich.console import Console

from grader.catalog import Catalog
from grader.commands.check import EXIT_FULL_MARKS, EXIT_NOT_FULL, handed_in_name, read_handed_in
from grader.commands.options import ASSIGNMENT_HELP, JSON_HELP, add_language_option, tell
from grader.contracts.errors import InfrastructureError, RefusedError, UnknownAssignmentError
from grader.contracts.report import report_from
from grader.contracts.text import LANGUAGES, Text, trouble
from grader.messages.quantity import points
from grader.operation.settings import is_loopback
from grader.render.escape import visible
from grader.render.labels import status_word
from grader.render.terminal import console, render_report

_OPEN_STATES = ("queued", "running")
_TRIES = 4
_PAUSE_S = 0.25
_LONGEST_PAUSE_S = 1.0
_TIMEOUT_S = 30.0
_NO_TOKEN = Text(
    zh="这不是令牌：令牌是一串英文字母、数字、- 和 _",
    en="this is no token: it is one word of letters, digits, - and _",
)
_TOKEN_FIX = Text(
    zh="把教师发给你的令牌存进一个文件，用 --token-file 指明（或放进环境变量 GRADER_TOKEN）；"
    "过期或遗失时要一个新的。",
    en="Put the token your instructor gave you into a file and name it with --token-file (or set GRADER_TOKEN); "
    "ask for a new one when it expired or got lost.",
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("file", type=Path, help="the script or answer to hand in / 要提交的文件")
    parser.add_argument(
        "--server",
        default=os.environ.get("GRADER_SERVER", "http://127.0.0.1:8080"),
        help="address of the service / 服务器地址 (GRADER_SERVER, else http://127.0.0.1:8080)",
    )
    parser.add_argument("-a", "--assignment", help=ASSIGNMENT_HELP)
    parser.add_argument("--student", default="", help="student id; not with a token / 学号，有令牌时不用写")
    parser.add_argument(
        "--token-file",
        type=Path,
        metavar="FILE",
        help="file with your token (default: GRADER_TOKEN) / 存着令牌的文件",
    )
    add_language_option(parser)
    parser.add_argument("--json", action="store_true", help=JSON_HELP)


def run(arguments: argparse.Namespace) -> int:
    """Hand in and wait; 0 full marks, 1 not, 2 could not be handed in or graded (raised as GraderError)."""
    _check_address(arguments.server)
    source = read_handed_in(arguments.file)
    assignment_id = arguments.assignment or _guess(arguments.file.name)
    headers = {"Accept-Language": arguments.lang, **_authorization(arguments)}
    with httpx.Client(base_url=arguments.server, headers=headers, timeout=_TIMEOUT_S) as client:
        url = _upload(client, arguments, source, assignment_id)
        page = _page(arguments.server, url)
        try:
            document = _await(client, url, arguments)
        except KeyboardInterrupt:
            tell(
                arguments,
                zh=f"文件已经提交，评分会继续。在网页上看结果：{page}",
                en=f"The file is handed in and will be graded. See the result at {page}",
            )
            raise
        content = _asked(client, "GET", url + "/report").content
        assignment = _asked(client, "GET", f"/api/v1/assignments/{document['assignment']}").json()
        left = _attempts_left(client, document["assignment"])
    if arguments.json:
        sys.stdout.write(content.decode() + "\n")
    report = report_from(content)
    if not arguments.json:
        console().print(
            render_report(
                report,
                language=arguments.lang,
                file_name=arguments.file.name,
                title=_text(assignment["title"]),
                cases={case["id"]: _text(case["title"]) for case in assignment["cases"]},
            )
        )
    _tell_lateness(document, arguments)
    tell(arguments, zh=f"在网页上看：{page}", en=f"See it at {page}")
    if left is not None and not arguments.student:
        tell(arguments, zh=f"还可提交 {left} 次。", en=f"Attempts left: {left}.")
    return EXIT_FULL_MARKS if report.score == report.max_score else EXIT_NOT_FULL


def _text(said: str) -> Text:
    """Return what the service said, in the language it was asked for."""
    return Text(zh=said, en=said)


def _upload(client: httpx.Client, arguments: argparse.Namespace, source: bytes, assignment: str) -> str:
    response = _asked(
        client,
        "POST",
        "/api/v1/submissions",
        data={"assignment": assignment, "student": arguments.student},
        files={"file": (handed_in_name(arguments.file), source)},
        headers={"Idempotency-Key": uuid.uuid4().hex},  # a lost answer must not cost an attempt
    )
    receipt = response.json()
    if receipt["repeated"]:
        tell(
            arguments,
            zh="这个文件之前已经提交过，不再占用次数；下面是那一次的结果。",
            en="This file was handed in before and costs no attempt; this is what became of it then.",
        )
    return str(receipt["status_url"])


def _page(server: str, status_url: str) -> str:
    """Return the address of a submission's page, which has the replay."""
    return f"{server.rstrip('/')}/submissions/{status_url.rstrip('/').rpartition('/')[2]}"


def _tell_lateness(document: dict[str, Any], arguments: argparse.Namespace) -> None:
    kept = document["kept_score"]
    if kept is not None and kept != document["score"]:
        tell(
            arguments,
            zh=f"截止后提交，按规则计 {points(kept)} 分。",
            en=f"Handed in after it was due: {points(kept)} points are kept.",
        )


def _attempts_left(client: httpx.Client, assignment: str) -> int | None:
    """Return how many attempts the owner of the token has left; None: any number, or the rules are unknown."""
    if "Authorization" not in client.headers:
        return None
    try:
        response = client.get(f"/api/v1/assignments/{assignment}/rules")
        left = response.json().get("attempts_left") if response.is_success else None
    except (httpx.TransportError, ValueError, AttributeError):
        return None  # this only adds to the result: without it the result is shown all the same
    return left if isinstance(left, int) else None


def _await(client: httpx.Client, url: str, arguments: argparse.Namespace) -> dict[str, Any]:
    """Show where the submission stands until it is graded; return its document."""
    pause_s = _PAUSE_S
    progress = Console(stderr=True, markup=False, emoji=False, highlight=False)
    with progress.status("") as display:
        while True:
            document: dict[str, Any] = _asked(client, "GET", url).json()
            if document["status"] not in _OPEN_STATES:
                break
            display.update(_standing(document, arguments))
            time.sleep(pause_s)
            pause_s = min(pause_s * 1.2, _LONGEST_PAUSE_S)
    if document["status"] != "graded":
        raise InfrastructureError(*(status_word(document["status"], language) for language in ("en", "zh")))
    return document


def _standing(document: dict[str, Any], arguments: argparse.Namespace) -> str:
    state = status_word(document["status"], arguments.lang)
    position = document["queue_position"]
    return state if position is None else f"{state} ({position + 1})"


def _asked(client: httpx.Client, method: str, url: str, **content: Any) -> httpx.Response:
    """Return the answer to a request that may be sent again when none came."""
    for attempt in range(_TRIES):
        try:
            response = client.request(method, url, **content)
        except httpx.TransportError as error:
            if attempt == _TRIES - 1:
                raise InfrastructureError(
                    f"{client.base_url} does not answer ({error}): is the address right, the service running?",
                    f"{client.base_url} 没有回应（{error}）：地址对不对？服务在运行吗？",
                ) from error
        else:
            wait = response.headers.get("Retry-After", "")
            if response.status_code not in (429, 503) or attempt == _TRIES - 1:
                return _accepted(response)
            time.sleep(min(float(wait) if wait.isdecimal() else 1.0, 60.0))
            continue
        time.sleep(_PAUSE_S * 2**attempt)
    raise AssertionError("the last try returns or raises")


def _accepted(response: httpx.Response) -> httpx.Response:
    if response.is_success:
        return response
    try:
        problem = response.json()
        code, title, detail = (str(problem[name]) for name in ("code", "title", "detail"))
        fix = _TOKEN_FIX if code == "unauthorized" else Text(zh=problem["fix"], en=problem["fix"])
        allowed = ", ".join(str(name) for name in problem.get("allowed") or ())
        lines = [title, detail if detail != title else "", problem.get("text") or ""]
        lines.append(f"allowed: {allowed}" if allowed else "")
    except (ValueError, KeyError, TypeError):
        raise InfrastructureError(
            f"{response.url} answered {response.status_code}: is --server the address of a grader?",
            f"{response.url} 回答了 {response.status_code}：--server 是不是评分服务的地址？",
        ) from None
    zh, en = ("\n".join(visible(str(line)) for line in (*lines, fix.get(lang)) if line) for lang in LANGUAGES)
    raise RefusedError.saying(code, zh=zh, en=en)


def _check_address(server: str) -> None:
    try:
        url = httpx.URL(server)
        usable = url.scheme in ("http", "https") and url.host != ""
    except httpx.InvalidURL:
        usable = False
    if not usable:
        raise RefusedError.saying(
            "server",
            zh=f"--server {server}：不是服务器地址，例如 https://grader.example.org",
            en=f"--server {server}: this is no address such as https://grader.example.org",
        )


def _text_of(content: bytes) -> str:
    """Return a short text as editors save it; Notepad's and PowerShell's begin with a byte order mark."""
    is_utf16 = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return content.decode("utf-16" if is_utf16 else "utf-8-sig")


def _authorization(arguments: argparse.Namespace) -> dict[str, str]:
    token = os.environ.get("GRADER_TOKEN", "")
    if arguments.token_file is not None:
        try:
            token = _text_of(arguments.token_file.read_bytes())
        except (OSError, UnicodeDecodeError) as error:
            told = trouble(error) if isinstance(error, OSError) else _NO_TOKEN
            raise RefusedError("token", told.about(f"--token-file {arguments.token_file}")) from error
    token = token.strip()
    if not token:
        return {}
    address = urlsplit(arguments.server)
    if address.scheme != "https" and not is_loopback(address.hostname or ""):
        raise RefusedError.saying(
            "token",
            zh=f"{arguments.server} 没有加密：令牌只能通过 https 发送",
            en=f"{arguments.server} is not encrypted: a token goes over https only",
        )
    if not (token.isascii() and token.isprintable()) or " " in token:
        raise RefusedError("token", _NO_TOKEN)
    return {"Authorization": f"Bearer {token}"}


def _guess(file_name: str) -> str:
    guess = Catalog().guess_assignment(file_name)
    if guess is None:
        raise UnknownAssignmentError.unguessed(file_name)
    return guess
