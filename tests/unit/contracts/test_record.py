"""A record is what `dataclass(frozen=True, slots=True, kw_only=True)` makes, and is read back strictly."""

import copy
import dataclasses
import json
import pickle
import subprocess
import sys
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from enum import StrEnum
from math import isnan, nan
from typing import Any, Literal

import pytest

from grader.contracts.record import Record, field, from_json, from_plain, to_plain


class Point(Record):
    """A point."""

    x: float
    y: float = 2.0
    tags: tuple[str, ...] = ()
    notes: dict[str, int] = field(default_factory=dict)

    @property
    def sum(self) -> float:
        """Of both."""
        return self.x + self.y


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """A point."""

    x: float
    y: float = 2.0
    tags: tuple[str, ...] = ()
    notes: dict[str, int] = dataclasses.field(default_factory=dict)


class Plain(Record):
    """Can be hashed."""

    name: str


def test_it_takes_the_same_arguments_and_fills_in_the_same_defaults() -> None:
    for arguments in ({"x": 1.0}, {"y": 5.0, "x": 1.0}, {"x": 1.0, "notes": {"a": 1}, "tags": ("t",)}):
        assert asdict(Point(**arguments)) == asdict(Reference(**arguments))
    assert Point(x=1.0).notes is not Point(x=1.0).notes
    assert Point(x=1.0).sum == 3.0


@pytest.mark.parametrize(
    ("positional", "named"),
    [((), {}), ((1.0,), {}), ((), {"x": 1.0, "z": 1.0})],
    ids=["none", "order", "unknown"],
)
def test_it_refuses_the_same_arguments(positional: tuple[float, ...], named: dict[str, float]) -> None:
    for cls in (Point, Reference):
        with pytest.raises(TypeError):
            cls(*positional, **named)


def test_it_cannot_be_changed() -> None:
    point = Point(x=1.0)
    with pytest.raises(AttributeError):
        point.x = 2.0  # type: ignore[misc]
    with pytest.raises(AttributeError):
        del point.x
    with pytest.raises(AttributeError):
        point.other = 1.0  # type: ignore[attr-defined]
    assert not hasattr(point, "__dict__")


def test_equality_and_hash_are_by_value_and_class() -> None:
    assert Point(x=1.0) == Point(x=1.0, y=2.0)
    assert Point(x=1.0) != Point(x=1.5)
    assert Point(x=1.0) != Reference(x=1.0)
    assert hash(Plain(name="a")) == hash(Plain(name="a"))
    assert len({Plain(name="a"), Plain(name="a"), Plain(name="b")}) == 2
    with pytest.raises(TypeError):
        hash(Point(x=1.0))  # it holds a dict, as the reference would


def test_the_tools_for_dataclasses_work() -> None:
    point = Point(x=1.0, notes={"a": 1})
    assert replace(point, x=3.0) == Point(x=3.0, notes={"a": 1})
    assert [each.name for each in fields(Point)] == ["x", "y", "tags", "notes"]
    assert is_dataclass(point)
    assert repr(point) == repr(Reference(x=1.0, notes={"a": 1})).replace("Reference", "Point")


def test_it_can_be_copied() -> None:
    point = Point(x=1.0, notes={"a": 1})
    deep = copy.deepcopy(point)
    assert copy.copy(point) == deep == point
    assert deep.notes is not point.notes
    assert pickle.loads(pickle.dumps(Plain(name="a"))) == Plain(name="a")


class Pair(Record, kw_only=False):
    """Takes its arguments in order, too."""

    first: int
    second: str = "b"


def test_a_positional_record_takes_its_arguments_in_order() -> None:
    assert Pair(1) == Pair(first=1, second="b") == Pair(1, "b")
    with pytest.raises(AttributeError):
        Pair(1).first = 2  # type: ignore[misc]


class Kind(StrEnum):
    """Two of them."""

    ONE = "one"
    TWO = "two"


class Tree(Record):
    """A field of each type that contracts have."""

    kind: Kind = Kind.ONE
    word: Literal["a", "b"] = "a"
    count: int = 0
    share: float | None = None
    flags: tuple[bool, ...] = ()
    scalars: dict[str, float | int | str | bool] = field(default_factory=dict)
    points: tuple[tuple[float, float], ...] = ()
    branches: tuple[Plain, ...] = ()


TREE = Tree(
    kind=Kind.TWO,
    share=0.1,
    flags=(True,),
    scalars={"float": 1.0, "int": 1, "str": "1", "bool": True},
    points=((1.0, 2.5),),
    branches=(Plain(name="左"),),
)


def test_what_was_written_is_read_back_as_it_was() -> None:
    text = json.dumps(TREE, default=to_plain)
    for back in (from_json(Tree, text), from_json(Tree, text.encode()), from_plain(Tree, json.loads(text))):
        assert back == TREE
        assert {name: type(value) for name, value in back.scalars.items()} == {
            "float": float,
            "int": int,
            "str": str,
            "bool": bool,
        }


@pytest.mark.parametrize(
    ("document", "named"),
    [
        ({"cont": 1}, "cont"),
        ({"kind": "three"}, "kind"),
        ({"word": "c"}, "word"),
        ({"count": 1.0}, "count"),
        ({"count": "1"}, "count"),
        ({"count": True}, "count"),
        ({"count": None}, "count"),
        ({"share": "0.1"}, "share"),
        ({"share": True}, "share"),
        ({"flags": [1]}, "flags"),
        ({"flags": "1"}, "flags"),
        ({"scalars": {"a": None}}, "scalars"),
        ({"scalars": [1]}, "scalars"),
        ({"points": [[1.0, 2.0, 3.0]]}, "points"),
        ({"branches": [{}]}, "branches"),
        ({"branches": [{"name": "a", "size": 1}]}, "branches"),
        ([], "object"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(document: Any, named: str) -> None:
    with pytest.raises(ValueError, match=named):
        from_plain(Tree, document)
    with pytest.raises(ValueError, match=named):
        from_json(Tree, json.dumps(document))


def test_what_is_no_number_is_no_json_either() -> None:
    """`json` writes and reads NaN, the store's readers do not; a report with one is refused when it is made."""
    assert isnan(from_plain(Tree, json.loads(json.dumps(Tree(share=nan), default=to_plain))).share or 0.0)
    with pytest.raises(ValueError, match="malformed"):
        from_json(Tree, '{"share": NaN}')


def test_only_records_have_a_plain_form() -> None:
    with pytest.raises(TypeError):
        json.dumps({"a": object()}, default=to_plain)


_TWO_THREADS = """
import threading
from grader.contracts.record import Record, {reader}

looking, done = threading.Event(), threading.Event()

def look():
    looking.set()
    done.wait(0.3)
    return int

class Inner(Record):
    number: "look()"

class Outer(Record):
    inner: Inner

def second():
    looking.wait()
    print({reader}(Outer, {data}))
    done.set()

thread = threading.Thread(target=second)
thread.start()
print({reader}(Outer, {data}))
thread.join()
"""


@pytest.mark.parametrize(
    ("reader", "data"),
    [("from_json", """b'{"inner": {"number": 1}}'"""), ("from_plain", '{"inner": {"number": 1}}')],
)
def test_a_class_that_another_thread_reads_for_the_first_time_waits_for_it(reader: str, data: str) -> None:
    """Or msgspec uses fields that it has not described yet, and the process is gone."""
    script = _TWO_THREADS.format(reader=reader, data=data)
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("Outer(inner=Inner(number=1))") == 2
