"""Ids that the code puts together have a text for every value that can come.

`grader.messages.check` sees such an id as a pattern: it proves that each text is used, not that none is missing.
A missing one is a page that answers 500, and only when somebody does the rare thing.
"""

import ast
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import get_args

import pytest

import grader
from grader.contracts import rules
from grader.contracts.appeal import AppealState
from grader.contracts.assignment import WAYS_TO_RUN, Input, SolidKind
from grader.contracts.fields import Choice, Count, Table, kinds_of
from grader.contracts.identity import Role
from grader.contracts.notice import NoticeKind, Outlet, Vendor
from grader.contracts.outcome import RunStatus
from grader.contracts.regrade import Which
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.rules import LATE_PARAMETERS, Extension, LateKind, LateRule, RefusalCode, Rules
from grader.contracts.submission import SubmissionState
from grader.formats.sheets.patching import LOSSES
from grader.messages import details, entries, exceptions
from grader.messages.check import fields
from grader.outside.notices import Failure
from grader.render.audit_lines import ACTIONS, FIELDS
from grader.render.audit_lines import KINDS as AUDIT_KINDS
from grader.service.routes.problems import PROBLEM_TYPES
from grader.service.web import (
    course_pages,
    notices,
    own_pages,
    people_pages,
    platforms,
    playground,
    practice,
    result,
    submission,
)
from grader.service.web.appeals import AnswerForm
from grader.service.web.matrix import SHOWS
from grader.service.web.regrade_table import PARTS
from grader.use_cases.risk import REASONS

ROOT = Path(grader.__file__).parent
_JOINED = re.compile(r"""["']([a-z0-9_.]+\.)["'] ~""")


def options(annotated: object) -> list[str]:
    """Return what an annotated choice of a form or an address may be, beside nothing."""
    literal = getattr(annotated, "__origin__", annotated)
    return [one for one in get_args(literal) if one]


TEMPLATES: Mapping[str, Iterable[str]] = {
    "appeal.decide.": options(AnswerForm.model_fields["decision"].annotation),
    "appeal.show.": ("open", "answered"),
    "appeal.state.": AppealState,
    "assignments.": get_args(Input),
    "class.show.": SHOWS,
    "course.done.": options(course_pages.Done),
    "filled.lost.": ("formats", "extensions", *LOSSES),
    "risk.": REASONS,
    "notices.done.": options(notices.Done),
    "notices.failure.": get_args(Failure),
    "notices.kind.": NoticeKind,
    "notices.outlet.": Outlet,
    "notices.outlet_hint.": options(notices.Group),
    "notices.vendor.": Vendor,
    "notices.wish.": NoticeKind,
    "own.done.": options(own_pages.Done),
    "people.done.": options(people_pages.Done),
    "people.role.": Role,
    "platforms.": platforms._OURS,
    "platforms.field.": ("title", "issuer", "client_id", "deployment", "login_url", "keys_url", "token_url"),
    "regrade.part.": PARTS,
    "regrade.which.": get_args(Which),
    "result.closed.": get_args(RefusalCode),
    "rules.": [
        *kinds_of(Rules),
        *(name for own in LATE_PARAMETERS.values() for name in own if name != "steps"),
    ],
    "rules.corrected_by.": rules.Corrector,
    "rules.hints.": rules.HintRule,
    "rules.counts.": rules.Counts,
    "rules.hint.": (),  # where there is none, the form has none
    "rules.late.": LATE_PARAMETERS,
    "rules.runs_as.": WAYS_TO_RUN,
    "rules.shown.": rules.Shown,
    "rubric_form.": ("low", "high", "ramp"),
    "run.": ("stdout", "stderr"),
}
"""What pages put together, ``say('appeal.state.' ~ one)``: the beginning of the id, and all that may follow."""

CODE: Mapping[str, Iterable[str]] = {
    "at_wall.": {"left", "right", "top", "bottom", *get_args(SolidKind)}
    - {"edge"},  # edges are called by side
    "detail.": details._KNOWN.values(),
    "item_status.": ItemStatus,
    "page.": FIELDS.values(),
    "page.audit.action.": ACTIONS,
    "page.audit.kind.": AUDIT_KINDS,
    "page.figure.": submission._FIGURE_WORDS,
    "page.playground.": playground._WORDS,
    "page.practice.": practice._WORDS,
    "page.replay.": result._REPLAY_WORDS,
    "problem.": [f"{code}.{part}" for code in PROBLEM_TYPES for part in ("title", "fix")],
    "stall.": details._REASONS.values(),
    "status.": [*GradeStatus, *RunStatus, *SubmissionState],
}
"""The same of what is no template: the beginning of the whole id."""


def missing(ids: Iterable[str]) -> set[str]:
    """Return the ids without a text. (The languages have the same ids: `check.faults`.)

    A word that reports have, too, is one of a page without standing there a second time.
    """
    reports = set(entries("en", "grader"))
    words = {one.replace("word.", "page.", 1) for one in reports if one.startswith("word.")}
    return set(ids) - reports - words - set(entries("en", "pages"))


def calls_of(name: str, module: Path) -> list[ast.Call]:
    text = module.read_text(encoding="utf-8")
    if name not in text:  # parsing the whole grader takes a second
        return []
    nodes = ast.walk(ast.parse(text))
    return [one for one in nodes if isinstance(one, ast.Call) and getattr(one.func, "id", "") == name]


@pytest.mark.parametrize("start", TEMPLATES)
def test_what_a_page_puts_together_has_a_text(start: str) -> None:
    assert not missing(f"page.{start}{one}" for one in TEMPLATES[start])


@pytest.mark.parametrize("start", CODE)
def test_what_the_code_puts_together_has_a_text(start: str) -> None:
    assert not missing(start + one for one in CODE[start])


def test_everything_that_pages_put_together_is_listed() -> None:
    """A page that begins to put ids together says above what may come."""
    found = {
        one for path in ROOT.rglob("*.html") for one in _JOINED.findall(path.read_text(encoding="utf-8"))
    }
    assert found == set(TEMPLATES)


def test_every_rule_has_its_texts() -> None:
    choices = {name: kind for name, kind in kinds_of(Rules).items() if isinstance(kind, Choice)}
    tables = [
        name for of in (Rules, LateRule) for name, kind in kinds_of(of).items() if isinstance(kind, Table)
    ]
    assert not missing(f"page.rules.{name}" for name in (*kinds_of(Rules), *kinds_of(Extension)))
    assert not missing(f"page.rules.{name}.{one}" for name, kind in choices.items() for one in kind.options)
    assert not missing(f"page.rules.{name}.line" for name in tables)


def test_every_late_rule_has_its_texts() -> None:
    """Its name in the form, and what it says in one line with the values of its own fields, of no others."""
    assert set(LATE_PARAMETERS) == set(get_args(LateKind))
    for kind, own in LATE_PARAMETERS.items():
        assert not missing([f"page.rules.late.{kind}", f"page.rules.late_short.{kind}"])
        assert fields(entries("en", "pages")[f"page.rules.late_short.{kind}"]) <= set(own)


def test_every_error_of_a_rule_has_its_text() -> None:
    """Those that contracts raise, and those of numbers as the form reads them."""
    named = [call.args[1] for call in calls_of("RuleError", Path(rules.__file__))]
    codes = [one.value for one in named if isinstance(one, ast.Constant)]
    counts = [kind for of in (Rules, Extension) for kind in kinds_of(of).values() if isinstance(kind, Count)]
    assert len(codes) >= 10
    assert not missing(
        f"page.rules.error.{code}" for code in [*codes, *(f"count_from_{one.low}" for one in counts)]
    )
    assert not [
        path for path in ROOT.rglob("*.py") if path != Path(rules.__file__) and calls_of("RuleError", path)
    ]


def test_every_error_of_a_form_has_its_text() -> None:
    """Forms keep the id of the sentence and say it later."""
    ids = {
        node.value
        for path in (ROOT / "service" / "web").glob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and re.fullmatch(r"[a-z]+\.error\.\w*[a-z0-9]", str(node.value))
    }
    assert len(ids) > 20
    assert not missing(f"page.{one}" for one in ids)


def test_every_cause_of_an_exception_has_its_sentence() -> None:
    """A code and the values of its sentence are returned together: ``return "misspelt", {...}``."""
    signs = {code for code, _ in exceptions.signs()}
    named = set(causes_in(ROOT / "messages" / "exceptions.py"))
    assert len(named) >= 10
    assert not missing(f"mistake.{code}" for code in signs | named)


def causes_in(module: Path) -> Collection[str]:
    nodes = ast.walk(ast.parse(module.read_text(encoding="utf-8")))
    pairs = [one.elts for one in nodes if isinstance(one, ast.Tuple) and len(one.elts) == 2]
    return [
        first.value
        for first, second in pairs
        if isinstance(first, ast.Constant) and isinstance(first.value, str) and isinstance(second, ast.Dict)
    ]
