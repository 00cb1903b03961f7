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


def written(document: Any) -> str:
    """Return the text of a document, a line for each value."""
    return json.dumps(document, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def test_the_interface_is_the_one_that_is_committed() -> None:
    document = form(openapi_document())
    del document["info"]  # of every release
    found = written(document)
    if "GRADER_OPENAPI_RENEW" in os.environ:
        GOLDEN.write_text(found, encoding="utf-8")
    committed = GOLDEN.read_text(encoding="utf-8")
    lines = difflib.unified_diff(
        committed.splitlines(), found.splitlines(), GOLDEN.name, "the service's", lineterm="", n=6
    )
    if changed := "\n".join(lines):
        pytest.fail(f"{changed}\n\nWhere this is meant, renew {GOLDEN.name}:\n{RENEW}", pytrace=False)
