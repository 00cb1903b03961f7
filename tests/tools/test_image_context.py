"""The image is built from all that the wheel is made of; building it would show that only after minutes."""

import tomllib
from pathlib import Path

from tools.image.build import _CONTEXT

ROOT = Path(__file__).resolve().parents[2]
WHEEL = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"][
    "targets"
]["wheel"]
COPIED = [
    word
    for line in (ROOT / "Dockerfile").read_text(encoding="utf-8").splitlines()
    if line.startswith("COPY ") and "--from" not in line
    for word in line.split()[1:-1]
]


def test_what_the_wheel_includes_is_copied_into_the_image() -> None:
    sources = set(WHEEL["force-include"])
    assert [one for one in sources if one not in COPIED and one.split("/")[0] not in COPIED] == []
    assert [one for one in sources if one not in _CONTEXT and one.split("/")[0] not in _CONTEXT] == []


def test_what_is_copied_is_not_ignored() -> None:
    kept = {
        line[1:].rstrip("/") for line in (ROOT / ".dockerignore").read_text().splitlines() if line[:1] == "!"
    }
    assert [one for one in COPIED if one not in kept] == []
