"""Two tiers of tests: everyday and thorough.

Every promise has an everyday test. Thorough tests try the same promises on further inputs. These marks say which:

- ``thorough``: the whole test is thorough; another one tries the same promise.
- ``sweep(keep)``: of a long list of parameters, `keep` rows are everyday tests: the first, the last, and rows
  spread evenly between them.
- ``draws``: the test asks `examples` how many to try. Properties draw fewer without this mark.
- ``in_turn(*names)``: parameters that hardly depend on the others, such as the language of a page or the database
  of a query. Each combination of the other parameters is an everyday test with one value of these, and the next
  combination with the next value.

The choice applies when the whole suite is asked for. Whoever names a test, a file or a folder gets all of it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

_DATABASES = ("database_url", "blank_url")
"""Parameters that take turns in all tests, without the mark."""
_FURTHER = pytest.StashKey[int]()
_TESTS = Path(__file__).parent

# The same examples every time, and no deadline: a loaded machine must not fail a test.
_ALWAYS: dict[str, Any] = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.too_slow],
}
_SHARE = 4
"""Everyday tests draw this fraction of the examples of a property: one in so many."""
settings.register_profile("all", **_ALWAYS)
settings.register_profile("everyday", max_examples=100 // _SHARE, **_ALWAYS)


def examples(number: int) -> int:
    """Return how many examples to try of `number`, which stands for hypothesis's 100 where these are too many."""
    return -(-number // _SHARE) if settings.get_current_profile_name() == "everyday" else number


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("tiers").addoption
    group("--all", action="store_const", dest="tier", const="all", help="everyday and thorough tests")
    group("--rest", action="store_const", dest="tier", const="rest", help="only the thorough tests")


def choose_tier(config: pytest.Config) -> None:
    """Find out what is asked for, before tests are imported. The processes that run them are told as an option."""
    option = config.option
    named = any(Path(one).resolve() not in (_TESTS, _TESTS.parent) for one in config.args)
    narrowed = named or option.keyword or option.markexpr or getattr(option, "lf", False)
    option.tier = option.tier or ("all" if narrowed else "everyday")
    settings.load_profile("everyday" if option.tier == "everyday" else "all")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.option.tier == "all":
        return
    everyday = everyday_tests(items)
    if config.option.tier == "rest":
        chosen = [item for item in items if item not in everyday or _draws(item)]
    else:
        chosen = [item for item in items if item in everyday]
        left_out = {item.path for item in items} - {item.path for item in chosen}
        if left_out:
            raise pytest.UsageError(f"no everyday test: {', '.join(map(str, sorted(left_out)))}")
    config.stash[_FURTHER] = len(items) - len(chosen)
    kept = set(chosen)
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = chosen


def _draws(item: pytest.Item) -> bool:
    """Whether it draws more examples than as an everyday test."""
    by_hypothesis = getattr(getattr(item, "function", None), "is_hypothesis_test", False)
    return by_hypothesis or item.get_closest_marker("draws") is not None


def everyday_tests(items: list[pytest.Item]) -> set[pytest.Item]:
    """Choose the everyday tests; their order decides which value has its turn."""
    rows: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("thorough") is None:
            rows[item.nodeid.partition("[")[0]].append(item)
    turn = Counter[Path]()
    return {item for one in rows.values() for item in _swept(_in_turn(one, turn))}


def _swept(rows: list[pytest.Item]) -> list[pytest.Item]:
    mark = rows[0].get_closest_marker("sweep")
    return [rows[at] for at in spread(len(rows), *mark.args)] if mark else rows


def spread(number: int, keep: int) -> list[int]:
    """Choose `keep` of so many rows at equal distances, with the first and the last one."""
    if keep >= number:
        return list(range(number))
    return [at * (number - 1) // (keep - 1) for at in range(keep)] if keep > 1 else [0]


def _in_turn(rows: list[pytest.Item], turn: Counter[Path]) -> list[pytest.Item]:
    mark = rows[0].get_closest_marker("in_turn")
    names = (*_DATABASES, *(mark.args if mark else ()))
    alike = defaultdict(list)
    for row in rows:
        alike[tuple(_others(row, names))].append(row)
    chosen = []
    for group in alike.values():
        chosen.append(group[turn[rows[0].path] % len(group)])
        turn[rows[0].path] += len(group) > 1
    return chosen


def _others(row: pytest.Item, names: tuple[str, ...]) -> Iterator[int]:
    """Tell apart what a row has besides these parameters: rows of the same value have the same object."""
    params: dict[str, object] = row.callspec.params if hasattr(row, "callspec") else {}
    return (id(value) for name, value in params.items() if name not in names)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any, error: object) -> None:
    """Take over what a process of pytest-xdist counted."""
    if further := getattr(node, "workeroutput", {}).get("further"):
        node.config.stash[_FURTHER] = further


def pytest_sessionfinish(session: pytest.Session) -> None:
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["further"] = session.config.stash.get(_FURTHER, 0)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.option.tier == "everyday" and (further := config.stash.get(_FURTHER, 0)):
        terminalreporter.write_line(f"These were the everyday tests; `make test-all` runs {further} more.")
