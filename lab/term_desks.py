"""An instructor's steps through a term, twice: over HTTP, and on the pages in a real Chromium.

Both desks have the same methods, so that one script does a term at either. Nothing here needs the server's shell.
"""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import httpx

_PATIENCE_S = 900.0
_LOOK_S = 0.5
_REQUEST = """
    const one = document.querySelector(arguments[0]), form = one.form;
    if (!form) return ["GET", one.href, {}];
    const fields = [...new FormData(form, one)].filter(([, value]) => typeof value === "string");
    return [form.method.toUpperCase(), form.action, Object.fromEntries(fields)];
"""
_SHEET = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"


class HttpDesk:
    """The steps by the JSON interface."""

    def __init__(self, url: str, token: str) -> None:
        headers = {"Authorization": f"Bearer {token}", "Accept-Language": "en"}
        self.client = httpx.Client(base_url=url, headers=headers, timeout=120.0, trust_env=False)

    def _ask(self, method: str, path: str, **kwargs: Any) -> httpx.Response:
        answer = self.client.request(method, f"/api/v1{path}", **kwargs)
        if answer.is_error:
            raise RuntimeError(f"{method} {path}: {answer.status_code} {answer.text[:500]}")
        return answer

    def import_roster(self, path: Path) -> str:
        """Look at a class list first, then import it without its wrong rows."""
        file = {"file": (path.name, path.read_bytes(), _SHEET)}
        plan = self._ask("POST", "/members/import", files=file, params={"dry_run": True}).json()
        done = self._ask("POST", "/members/import", files=file, params={"skip": True}).json()
        return f"{len(done['added'])} added, {len(plan['skipped'])} rows skipped with a reason"

    def add_assistant(self, person: str, section: str) -> None:
        """Add somebody who looks after a section."""
        self._ask(
            "PUT", f"/members/{person}", json={"name": person, "role": "assistant", "sections": [section]}
        )

    def make_tokens(self, people: Sequence[str]) -> dict[str, str]:
        """Return a token of everybody, who has none yet."""
        return {
            one: self._ask("POST", f"/members/{one}/tokens", json={"days": 200}).json()["token"]
            for one in people
        }

    def upload_broken(self, content: bytes) -> str:
        """Return where the first thing is wrong in a folder that is."""
        answer = self.client.post("/api/v1/course/assignments", files={"file": ("a.zip", content)})
        assert answer.status_code == 422, answer.text
        return str(answer.json()["errors"][0]["field"])

    def upload(self, content: bytes) -> None:
        """Upload a folder."""
        self._ask("POST", "/course/assignments", files={"file": ("a.zip", content)})

    def await_ready(self, assignments: Sequence[str]) -> None:
        """Wait until the scripts of uploads have been run, and got what they must."""
        _until(lambda: self._states(assignments) == {"ready"})

    def _states(self, assignments: Sequence[str]) -> set[str]:
        listed = self._ask("GET", "/course/assignments").json()["assignments"]
        states = {one["state"] for one in listed if one["assignment"] in assignments}
        assert "refused" not in states, listed
        return states

    def publish(self, chosen: Sequence[str], due: datetime, appeals_until: datetime) -> None:
        """Show some assignments, with dates, and hide all others."""
        for one in self._ask("GET", "/assignments").json()["assignments"]:
            rules: dict[str, Any] = {"shown": "draft"}
            if one["id"] in chosen:
                rules = {
                    "shown": "always",
                    "due": due.isoformat(),
                    "appeals_until": appeals_until.isoformat(),
                }
            self._ask("PUT", f"/assignments/{one['id']}/rules", json=rules)

    def set_section(self, assignment: str, section: str, due: datetime, per_day_percent: int) -> None:
        """Give one section a date and a late rule of its own."""
        answer = self._ask("GET", f"/assignments/{assignment}/rules")
        rules = answer.json()["rules"]
        late = {"kind": "linear", "per_day": per_day_percent / 100}
        rules["by_section"] = [
            *(one for one in rules["by_section"] if one["section"] != section),
            {"section": section, "due": due.isoformat(), "late": late},
        ]
        headers = {"If-Match": answer.headers["ETag"]}
        self._ask("PUT", f"/assignments/{assignment}/rules", json=rules, headers=headers)

    def answer_appeal(self, submission: str, item: str, decision: str, points: float) -> None:
        """Answer one appeal."""
        body: dict[str, Any] = {"state": decision, "text": "Looked at again."}
        if decision == "corrected":
            body["points"] = points
        self._ask("PUT", f"/submissions/{submission}/appeals/{item}", json=body)

    def regrade(self, assignment: str) -> str:
        """Grade everybody's latest again, on trial; return which re-grade, once all are graded."""
        made = self._ask("POST", "/regrades", json={"assignment": assignment, "which": "latest"}).json()
        _until(lambda: not self._ask("GET", f"/regrades/{made['id']}").json()["waiting"])
        return str(made["id"])

    def apply_and_undo(self, regrade: str) -> None:
        """Let the new scores count, then the old ones again."""
        self._ask("POST", f"/regrades/{regrade}/apply", json={"reason": "the rubric was changed"})
        self._ask("POST", f"/regrades/{regrade}/undo", json={"reason": "not yet"})

    def remove(self, person: str) -> None:
        """Take somebody out of the course."""
        self._ask("DELETE", f"/members/{person}", params={"reason": "left"})

    def forget(self, person: str) -> None:
        """Erase somebody."""
        self._ask("POST", f"/members/{person}/forget", json={"reason": "asked for it"})

    def fill_sheet(self, path: Path, column: str) -> bytes:
        """Return a teacher's own sheet with points in it."""
        file = {"file": (path.name, path.read_bytes(), _SHEET)}
        return self._ask("POST", "/gradebook/fill", files=file, params={"column": column}).content

    def download(self, folder: Path) -> int:
        """Save everything of the course; return its bytes."""
        path = folder / "export-http.zip"
        path.write_bytes(self._ask("GET", "/course/export.zip").content)
        return path.stat().st_size

    def archive(self) -> None:
        """Let the course be read only."""
        self._ask("PUT", "/course/archived", json={"archived": True, "reason": "the term is over"})

    def copy(self, course: str) -> str:
        """Make the next term's course; return its instructor's token."""
        made = self._ask("POST", "/courses", json={"id": course, "move_days": 364}).json()
        return str(made["token"])


class PageDesk:
    """The steps on the pages. `browser` is `tests.e2e.chromium.Browser`, signed in as the instructor."""

    def __init__(self, browser: Any, folder: Path) -> None:
        self.browser = browser
        self.folder = folder

    def import_roster(self, path: Path) -> str:
        """Look at a class list first, then import it without its wrong rows."""
        page = self.browser
        page.open("/class/people?lang=en")
        page.one("form[aria-labelledby=import] #file").send_keys(str(path))
        page.click("form[aria-labelledby=import] button")
        skipped = len(page.all("th.row-number ~ th")) and len(page.all("table:has(.row-number) tbody tr"))
        page.click('form[action="/class/people/import"] button')
        assert "done=imported" in page.driver.current_url, page.says()
        return f"{skipped} rows skipped with a reason"

    def add_assistant(self, person: str, section: str) -> None:
        """Add somebody who looks after a section."""
        page = self.browser
        page.open("/class/people")
        page.type("#person", person)
        page.type("form[aria-labelledby=add] #name", person)
        page.one("#role option[value=assistant]").click()
        page.type("#sections", section)
        self._send("form[aria-labelledby=add] button")

    def make_tokens(self, people: Sequence[str]) -> dict[str, str]:
        """Return a token of everybody, who has none yet."""
        self.browser.open("/class/people")
        content = self._fetched("form[aria-labelledby=tokens] button[value=csv]")
        rows = csv.DictReader(io.StringIO(content.decode("utf-8-sig")))
        return {row["id"]: row["token"] for row in rows}

    def upload_broken(self, content: bytes) -> str:
        """Return where the first thing is wrong in a folder that is."""
        self._upload(content)
        return ": ".join(str(self.browser.one("main table tbody th").text).split())

    def upload(self, content: bytes) -> None:
        """Upload a folder."""
        self._upload(content)
        assert "done=uploaded" in self.browser.driver.current_url, self.browser.says()

    def _upload(self, content: bytes) -> None:
        path = self.folder / "upload.zip"
        path.write_bytes(content)
        self.browser.open("/class/own")
        self.browser.one("#file").send_keys(str(path))
        self.browser.click("form[aria-labelledby=upload] button")

    def await_ready(self, assignments: Sequence[str]) -> None:
        """Wait until the scripts of uploads have been run, and got what they must."""
        _until(self._all_ready)

    def _all_ready(self) -> bool:
        self.browser.open("/class/own")
        assert not self.browser.all("main .mark.failed"), self.browser.says()
        return not self.browser.all("main .mark.pending")

    def publish(self, chosen: Sequence[str], due: datetime, appeals_until: datetime) -> None:
        """Show some assignments, with dates, and hide all others: two forms."""
        page = self.browser
        for shown in (True, False):
            page.open("/class/rules")
            script = """
                for (const one of document.querySelectorAll('td.pick input'))
                    one.checked = arguments[0].includes(one.value) === arguments[1];
            """
            page.js(script, list(chosen), shown)
            page.one(f"#shown option[value={'always' if shown else 'draft'}]").click()
            if shown:
                self._date("#due", due)
                self._date("#appeals_until", appeals_until)
            self._send("button[name=action][value=rules]")

    def set_section(self, assignment: str, section: str, due: datetime, per_day_percent: int) -> None:
        """Give one section a date and a late rule of its own."""
        page = self.browser
        page.open(f"/class/rules/{assignment}/section?name={section}")
        self._date("#due", due)
        page.js("document.querySelector('#late-linear').click()")
        page.type("input[name=per_day]", str(per_day_percent))
        self._send("form.rules button")

    def answer_appeal(self, submission: str, item: str, decision: str, points: float) -> None:
        """Answer one appeal."""
        page = self.browser
        page.open(f"/class/appeals/{submission}?item={item}")
        page.js(f"document.querySelector('input[name=decision][value={decision}]').click()")
        if decision == "corrected":
            page.type("#points", f"{points:g}")
        page.type("#text", "Looked at again.")
        self._send("main form button")

    def regrade(self, assignment: str) -> str:
        """Grade everybody's latest again, on trial; return which re-grade, once all are graded."""
        page = self.browser
        page.open("/class/regrades")
        page.one(f"#assignment option[value={assignment}]").click()
        page.one("input[name=which][value=latest]").click()
        page.click("form.order button")
        made = str(page.path)
        _until(lambda: page.open(made) or page.all("button[value=apply]"))
        return made.rpartition("/")[2]

    def apply_and_undo(self, regrade: str) -> None:
        """Let the new scores count, then the old ones again."""
        page = self.browser
        for decision in ("apply", "undo"):
            page.open(f"/class/regrades/{regrade}")
            if not page.one("#reason").is_displayed():
                page.js("for (const one of document.querySelectorAll('details')) one.open = true")
            page.type("#reason", f"a reason to {decision}")
            self._send(f"button[value={decision}]")

    def remove(self, person: str) -> None:
        """Take somebody out of the course."""
        self.browser.open(f"/class/people/{person}")
        self.browser.type("#reason", "left")
        self._send("form[aria-labelledby=remove] button")

    def forget(self, person: str) -> None:
        """Erase somebody."""
        page = self.browser
        page.open("/class/course")
        page.type("#forget-person", person)
        page.type("#forget-again", person)
        self._send("form[aria-labelledby=forget] button")

    def fill_sheet(self, path: Path, column: str) -> bytes:
        """Return a teacher's own sheet with points in it."""
        page = self.browser
        page.open("/class/gradebook")
        page.type("#column", column)
        return self._fetched("form[aria-labelledby=fill] button", file=path)

    def download(self, folder: Path) -> int:
        """Save everything of the course; return its bytes."""
        self.browser.open("/class/course")
        return len(self._fetched('a[href="/class/course/export.zip"]'))

    def archive(self) -> None:
        """Let the course be read only."""
        self.browser.open("/class/course")
        self._send("form[aria-labelledby=archive] button")

    def copy(self, course: str) -> str:
        """Make the next term's course; return its instructor's token."""
        page = self.browser
        page.open("/class/course")
        page.type("#id", course)
        page.click("form[aria-labelledby=copy] button")
        return str(page.says(".notice pre.code"))

    def _send(self, selector: str) -> None:
        """Send a form; complain when the page says that something is wrong."""
        self.browser.click(selector)
        assert not self.browser.all(".refusal"), self.browser.says()

    def _date(self, selector: str, at: datetime) -> None:
        script = "document.querySelector(arguments[0]).value = arguments[1]"
        self.browser.js(script, selector, at.strftime("%Y-%m-%dT%H:%M"))

    def _fetched(self, selector: str, **files: Path) -> bytes:
        """Return what a link or a form's button downloads; headless, the browser saves no file by itself."""
        page = self.browser
        cookies = {one["name"]: one["value"] for one in page.driver.get_cookies()}
        method, address, fields = page.js(_REQUEST, selector)
        sent = {name: (path.name, path.read_bytes(), _SHEET) for name, path in files.items()}
        with httpx.Client(cookies=cookies, timeout=120.0, trust_env=False) as client:
            answer = client.request(method, address, data=fields or None, files=sent or None)
        assert answer.status_code == 200, (address, answer.status_code)
        assert "attachment" in answer.headers["Content-Disposition"]
        return answer.content


def _until(condition: Any) -> None:
    deadline_s = time.monotonic() + _PATIENCE_S
    while not condition():
        if time.monotonic() > deadline_s:
            raise TimeoutError("it takes too long")
        time.sleep(_LOOK_S)


Desk = HttpDesk | PageDesk
