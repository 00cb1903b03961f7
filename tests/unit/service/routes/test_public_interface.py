"""The public JSON is what other programs rely on, so its form is committed: `tests/golden/openapi.json`.

That is the OpenAPI document without its prose. When a change of the form is meant, write the file anew and
look at the difference before committing it::

    GRADER_OPENAPI_RENEW=1 python -m pytest tests/unit/service/routes/test_public_interface.py
"""

import difflib
import json
import os
from typing import Any

import pytest

from tests.fakes.server import GOLDEN_OPENAPI as GOLDEN
from tests.fakes.server import openapi_document

PROSE = ("title", "summary", "description")
RENEW = "GRADER_OPENAPI_RENEW=1 python -m pytest tests/unit/service/routes/test_public_interface.py"


def form(part: Any) -> Any:
    """Return a part of the document without what only people read. A field may be called `title`, too."""
    if isinstance(part, list):
        return [form(one) for one in part]
    if not isinstance(part, dict):
        return part
    return {
        name: form(value)
        for name, value in part.items()
        if not (name in PROSE and isinstance(value, str)) and name not in ("example", "examples")
    }


WIDTH = 150


def written(part: Any, indent: int = 0) -> str:
    """Return a part of the document as JSON: a line where that is short, else one for each field or entry."""
    line = json.dumps(part, ensure_ascii=False, sort_keys=True)
    if len(line) + indent <= WIDTH or not isinstance(part, dict | list):
        return line
    inner = "\n" + " " * (indent + 1)
    if isinstance(part, list):
        return f"[{','.join(inner + written(one, indent + 1) for one in part)}{inner[:-1]}]"
    fields = (f"{inner}{json.dumps(name)}: {written(part[name], indent + 1)}" for name in sorted(part))
    return f"{{{','.join(fields)}{inner[:-1]}}}"


def test_the_interface_is_the_one_that_is_committed() -> None:
    document = form(openapi_document())
    del document["info"]  # of every release
    found = written(document) + "\n"
    if "GRADER_OPENAPI_RENEW" in os.environ:
        GOLDEN.write_text(found, encoding="utf-8")
    committed = GOLDEN.read_text(encoding="utf-8")
    lines = difflib.unified_diff(
        committed.splitlines(), found.splitlines(), GOLDEN.name, "the service's", lineterm="", n=6
    )
    if changed := "\n".join(lines):
        pytest.fail(f"{changed}\n\nWhere this is meant, renew {GOLDEN.name}:\n{RENEW}", pytrace=False)
