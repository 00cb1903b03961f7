"""`record` makes what `dataclass(frozen=True, slots=True, kw_only=True)` makes."""

import copy
import pickle
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, replace

import pytest

from grader.contracts.record import record


@record
class Point:
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
    notes: dict[str, int] = field(default_factory=dict)


@record
class Plain:
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
    with pytest.raises(FrozenInstanceError):
        point.x = 2.0  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError):
        del point.x
    with pytest.raises(FrozenInstanceError):
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
    assert repr(point) == repr(Reference(x=1.0, notes={"a": 1})).replace("Reference", "Point")


def test_it_can_be_copied() -> None:
    point = Point(x=1.0, notes={"a": 1})
    deep = copy.deepcopy(point)
    assert copy.copy(point) == deep == point
    assert deep.notes is not point.notes
    assert pickle.loads(pickle.dumps(Plain(name="a"))) == Plain(name="a")
