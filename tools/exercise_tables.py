"""Writes the tables of docs/exercises.md and docs/exercises.zh.md: ``python tools/exercise_tables.py``.

They name every check, measure, option, step and expectation. A test compares what stands there.
"""

from pathlib import Path

from grader.catalog.conversation import EXPECTATIONS, STEP_FIELDS
from grader.checks.kinds import KINDS
from grader.checks.measure import text_id
from grader.checks.package import MEASURES as PACKAGE_MEASURES
from grader.contracts.text import Language
from grader.messages import sentence

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES: dict[Language, Path] = {"en": DOCS / "exercises.md", "zh": DOCS / "exercises.zh.md"}
BEGIN, END = "<!-- tables: tools/exercise_tables.py -->", "<!-- end of tables -->"
_HEADS = {
    "en": (
        "`check` | measure | is | options of the check",
        "step | besides `id` and `at_s`",
        "expectation | fields",
    ),
    "zh": ("`check` | 测量值 | 是什么 | 检查的选项", "步骤 | 除 `id`、`at_s` 以外", "期望 | 字段"),
}
_FORMS = {
    "en": {"count": "a whole number", "flag": "1 or 0", "quantity": ""},
    "zh": {"count": "整数", "flag": "1 或 0", "quantity": ""},
}


def tables(language: Language) -> str:
    """Return the three tables."""
    checks, steps, expectations = _HEADS[language]
    rows = list(_measures(language))
    parts = [
        _table(checks, rows),
        _table(steps, [f"`{kind}` | {_code(fields)}" for kind, fields in STEP_FIELDS.items()]),
        _table(
            expectations,
            [f"`{each.kind}` | {_code([*each.model_fields])}" for each in EXPECTATIONS],
        ),
    ]
    return "\n\n".join(parts)


def _measures(language: Language) -> list[str]:
    rows = []
    for kind in KINDS.values():
        options = _code([*kind.options, *(f"{name}?" for name in kind.optional)])
        for name, measure in kind.measures.items():
            unit = measure.unit or _FORMS[language][measure.form]
            said = sentence(language, f"{text_id(kind, name)}.name")
            rows.append(f"`{kind.kind}` | `{name}` | {said}{f' ({unit})' if unit else ''} | {options}")
            options = ""
    for name in PACKAGE_MEASURES:
        rows.append(f"`input: package` | `{name}` | {sentence(language, f'package.{name}.name')} | ")
    return rows


def _code(names: list[str] | tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _table(head: str, rows: list[str]) -> str:
    columns = head.count("|") + 1
    lines = [f"| {head} |", "|" + "---|" * columns, *(f"| {row} |".replace("  |", " |") for row in rows)]
    return "\n".join(lines)


def with_tables(text: str, language: Language) -> str:
    """Return a page with its tables renewed."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n\n{tables(language)}\n\n{END}{after}"


if __name__ == "__main__":
    for language, page in PAGES.items():
        page.write_text(with_tables(page.read_text("utf-8"), language), encoding="utf-8")
