"""Hand in every script of /abuse, and after each of them a good one of a classmate; print what became of all.

Bo attacks, Ada does not. The last line says how many attempts this has cost Bo.
"""

import csv
import json
import time
from pathlib import Path

import httpx

from grader.catalog import Catalog

LINES = Path("/data/tokens.csv").read_text(encoding="utf-8-sig").splitlines()
TOKENS = {row["id"]: row["token"] for row in csv.DictReader(LINES)}
TOLD = ("status", "score", "verdict", "tries")


def bearer(person: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {TOKENS[person]}"}


def hand_in(client: httpx.Client, student: str, name: str, content: bytes) -> str:
    answer = client.post(
        "/api/v1/submissions",
        data={"assignment": "square"},
        files={"file": (name, content, "text/x-python")},
        headers=bearer(student),
    ).raise_for_status()
    return answer.headers["Location"]


def attempts_used(client: httpx.Client) -> int:
    told = client.get("/api/v1/assignments/square/rules", headers=bearer("bo")).raise_for_status()
    return told.json()["attempts_used"]


with httpx.Client(base_url="http://127.0.0.1:8080", timeout=60.0) as client:
    catalog = Catalog()
    good = catalog.own_file(catalog.get("square"), "solution").read_bytes()
    before = attempts_used(client)
    sent = []
    for number, path in enumerate(sorted(Path("/abuse").glob("*.py"))):
        sent.append((path.stem, hand_in(client, "bo", path.name, path.read_bytes())))
        sent.append(("good", hand_in(client, "ada", "good.py", good + b"\n# %d\n" % number)))
    for name, location in sent:
        headers = bearer("wang")
        while (told := client.get(location, headers=headers).raise_for_status().json())["finished_at"] is None:
            time.sleep(0.2)
        print(json.dumps({"script": name, **{key: told[key] for key in TOLD}}))
    print(json.dumps({"attempts": attempts_used(client) - before}))
