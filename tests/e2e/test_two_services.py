"""Two services behind the documented proxy: whatever a process keeps for itself, nobody has twice or misses."""

import csv
import os
import re
import shutil
import subprocess
import textwrap
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest
import websocket

from benchmarks.processes import free_port
from grader.service.web.static_files import address
from tests.e2e.test_scale_out import PATIENCE_S, process, serving
from tests.fakes.prepared import Prepared

ROOT = Path(__file__).resolve().parents[2]
MOST = 60
METRICS_TOKEN = "9xKq27LmVb0pTz41"
HELLO = (ROOT / "lesson" / "hello_node.py").read_bytes()


def sample() -> str:
    """The sample of docs/operator.md for one process."""
    text = (ROOT / "docs" / "operator.md").read_text(encoding="utf-8")
    start = text.index("    map $http_upgrade")
    return textwrap.dedent(text[start : text.index("\n\n", start)])


def upstreams() -> str:
    """What it says of a second one."""
    text = (ROOT / "docs" / "operator.md").read_text(encoding="utf-8")
    start = text.index("    upstream grader ", text.index("### Several services"))
    return textwrap.dedent(text[start : text.index("\n\n", start)])


def configuration(folder: Path, port: int, ports: tuple[int, int]) -> str:
    """Return the sample, without TLS and with the ports of this test."""
    text, (first, second) = sample(), ports
    text = re.sub(r"(?m)^upstream .*\n", "", text).replace("server {", upstreams() + "\nserver {", 1)
    text = re.sub(r"(?ms)^server \{\s+listen 80;.*?^\}\n", "", text)
    text = re.sub(r"(?m)^ +(ssl_certificate|add_header).*\n", "", text)
    text = text.replace("listen 443 ssl;", f"listen 127.0.0.1:{port};")
    text = text.replace("/var/lib/nginx/grader", f"{folder}/cache")
    text = text.replace(":8080", f":{first}").replace(":8081", f":{second}")
    paths = "".join(
        f"{one}_temp_path {folder}/{one};\n" for one in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    user = "user root;" if os.geteuid() == 0 else ""  # else its processes may not enter the folder
    return (
        f"daemon off; {user} pid {folder}/pid; error_log {folder}/error.log;\n"
        "events { worker_connections 200; }\n"
        f"http {{ access_log off; {paths} {text} }}\n"
    )


@pytest.fixture
def nginx() -> str:
    """The program."""
    program = shutil.which("nginx", path=f"{os.environ['PATH']}:/usr/sbin")
    if program is None and os.environ.get("GRADER_REQUIRE_NGINX"):
        pytest.fail("nginx is not installed, so the documented proxy was not tried")
    return program or pytest.skip("nginx is not installed, so the documented proxy was not tried")


class Behind:
    """Two services behind one port.

    Attributes:
        url: where everybody comes in. alone: each of the two, past the proxy. tokens: by person.
    """

    def __init__(self, url: str, alone: list[str], tokens: dict[str, str]) -> None:
        self.url = url
        self.alone = alone
        self.tokens = tokens

    def client(self, person: str) -> httpx.Client:
        headers = {"Authorization": f"Bearer {self.tokens[person]}"}
        return httpx.Client(base_url=self.url, headers=headers, timeout=PATIENCE_S, trust_env=False)


@pytest.fixture
def behind(
    postgres_url: str, tmp_path: Path, prepared: Prepared, nginx: str, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Behind]:
    monkeypatch.setenv("GRADER_REQUESTS_PER_MINUTE", str(MOST))
    monkeypatch.setenv("GRADER_METRICS_TOKEN", METRICS_TOKEN)
    with ExitStack() as stack:
        clients = []
        for name in ("one", "other"):
            (tmp_path / name).mkdir()
            clients.append(stack.enter_context(serving(prepared, tmp_path / name, postgres_url)))
        stack.enter_context(
            process(prepared, tmp_path / "worker.log", postgres_url, "worker", "--slots", "1")
        )
        tokens = enrolled(prepared, tmp_path, postgres_url)
        alone = [str(one.base_url).rstrip("/") for one in clients]
        port, (first, second) = free_port(), (int(one.rpartition(":")[2]) for one in alone)
        (tmp_path / "nginx.conf").write_text(configuration(tmp_path, port, (first, second)))
        command = [
            nginx,
            "-p",
            str(tmp_path),
            "-e",
            str(tmp_path / "error.log"),
            "-c",
            str(tmp_path / "nginx.conf"),
        ]
        proxy = subprocess.Popen(command)
        stack.callback(proxy.wait)
        stack.callback(proxy.terminate)
        transport = httpx.HTTPTransport(retries=10)
        with httpx.Client(transport=transport, trust_env=False) as client:
            assert client.get(f"http://127.0.0.1:{port}/healthz").status_code in (200, 503)
        yield Behind(f"http://127.0.0.1:{port}", alone, tokens)


def enrolled(prepared: Prepared, folder: Path, url: str) -> dict[str, str]:
    """Make a course; return everybody's token."""
    roster = folder / "class.csv"
    roster.write_text("id,name\namy,Amy\nbob,Bob\n")
    command = ("course", "create", "ros2", "--instructor", "wang", "--roster", str(roster))
    with (folder / "tokens").open("wb") as log:
        made = prepared.start("grader", *command, log=log.fileno(), GRADER_DATABASE_URL=url)
    with made:
        assert made.wait() == 0
    printed = (folder / "tokens").read_text(encoding="utf-8")
    rows = csv.DictReader(printed[printed.index("id,") :].splitlines())
    return {row["id"]: row["token"] for row in rows}


@pytest.mark.slow
def test_nothing_is_lost_or_had_twice_with_two_services(behind: Behind) -> None:
    with behind.client("amy") as amy, behind.client("bob") as bob:
        # a person has one car however often, and from wherever, it is asked for; its address leads there
        with ThreadPoolExecutor(6) as pool:
            cars = list(pool.map(lambda _: amy.post("/api/v1/live").json(), range(6)))
        assert len({one["url"] for one in cars}) == 1
        assert bob.post("/api/v1/live").json()["url"] != cars[0]["url"]
        connection = websocket.create_connection(cars[0]["url"], timeout=PATIENCE_S, suppress_origin=True)
        connection.send('{"op": "call_service", "service": "/rosapi/get_time", "id": "1"}')
        assert '"service_response"' in connection.recv()
        assert amy.get("/api/v1/live").json()["clients"] == 1
        connection.close()
        refused = [post_past_the_proxy(one, behind.tokens["amy"]) for one in behind.alone]
        assert sorted(refused) == [201, 503]  # the other one has no cars, and starts none

        answer = amy.post(
            "/api/v1/submissions", files={"file": ("a.py", HELLO)}, data={"assignment": "hello"}
        )
        assert answer.status_code == 202, answer.text
        for url in behind.alone:  # each of them tells how it goes, whoever took it in
            headers = {"Authorization": f"Bearer {behind.tokens['amy']}", "Accept": "text/event-stream"}
            place = f"{url}{answer.headers['Location']}/events"
            with httpx.stream("GET", place, headers=headers, timeout=PATIENCE_S, trust_env=False) as stream:
                assert any('"graded"' in line for line in stream.iter_lines())

        for _ in range(5):  # the proxy asks once for what holds for ever
            answer = bob.get(f"{address()}/style.css")
            assert (answer.status_code, answer.headers.get("content-encoding")) == (200, "gzip"), (
                answer.headers
            )
        assert sum(map(static_requests, behind.alone)) == 1

        # one process counts what a person asks for
        answers = []
        while len(answers) < 2 * MOST:
            answers.append(bob.get("/api/v1/assignments").status_code)
            time.sleep(0.02)  # the proxy has a limit as well
        assert set(answers) == {200, 429}
        assert answers.count(200) < 1.7 * MOST


def static_requests(url: str) -> int:
    """How many static files a service was asked for."""
    headers = {"Authorization": f"Bearer {METRICS_TOKEN}"}
    counts = httpx.get(f"{url}/metrics", headers=headers, timeout=PATIENCE_S, trust_env=False).text
    found = re.search(r'grader_http_request_seconds_count\{[^}]*route="/static"[^}]*\} (\d+)', counts)
    return int(found.group(1)) if found else 0


def post_past_the_proxy(url: str, token: str) -> int:
    headers = {"Authorization": f"Bearer {token}"}
    return httpx.post(f"{url}/api/v1/live", headers=headers, timeout=PATIENCE_S, trust_env=False).status_code
