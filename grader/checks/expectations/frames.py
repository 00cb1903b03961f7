"""Expectations of tf2's frames: who is whose parent, where, how turned, how often, at each time."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from functools import partial
from typing import Any, Final

from grader.checks.expectations.topics import _quantity
from grader.checks.expectations.verdict import (
    NS_PER_S,
    Evidence,
    Reason,
    Verdict,
    because,
    named,
    plain,
    unknown,
    wanted_of,
)
from grader.checks.measure import Mistake, mistake
from grader.contracts.conversation import Expectation
from grader.contracts.record import Record
from grader.contracts.text import EMPTY, Text
from grader.geometry import exact
from grader.messages import join, say

_AND = Text(zh="；", en="; ")
_STEP_NS: Final = 500_000_000
_MOST_LINKS: Final = 20

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class _Link(Record, kw_only=False):
    """One transform of a frame to its parent, as it was sent."""

    t_ns: int
    parent: str
    child: str
    translation: Vector
    rotation: Quaternion
    static: bool


def frame(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge a frame, as its parent sees it."""
    links = _links(evidence)
    own = [
        link
        for link in links
        if link.child == expectation.target and evidence.looks_at(expectation, link.t_ns)
    ]
    direct = [transform for transform in own if transform.parent == expectation.parent]
    wanted = _wanted_text(expectation)
    poses = _poses(expectation, evidence, links, direct)
    if not poses:
        used = named(f"{link.parent} → {link.child}" for link in links)
        came = plain(used) if links else say("expected.no_frames")
        return Verdict(share=0.0, wanted=wanted, came=came, why=lambda: _missing(expectation, links))
    if (
        expectation.static is not None
        and direct
        and any(transform.static is not expectation.static for transform in direct)
    ):
        topic = "/tf_static" if direct[0].static else "/tf"
        needed = "StaticTransformBroadcaster" if expectation.static else "TransformBroadcaster"
        why = because("frame_broadcaster", frame=expectation.target, wanted=needed)
        return Verdict(share=0.0, wanted=wanted, came=plain(topic), why=why)
    share, came, why, there = _where(expectation, evidence, poses)
    if expectation.rate_hz is not None or expectation.count is not None:
        often = _quantity(expectation, evidence, [transform.t_ns for transform in direct], 0)
        parts = ((share, came, why, there), (*often, wanted))
        share, came, why, there = min(parts, key=lambda part: part[0])
    return Verdict(share=share, wanted=there, came=came, why=why)


def _links(evidence: Evidence) -> list[_Link]:
    found = []
    for topic in ("/tf_static", "/tf"):
        for message in evidence.talk.heard.get(topic, ()):
            for value in (message.values or {}).get("transforms", ())[:50]:
                move, turn = value["transform"]["translation"], value["transform"]["rotation"]
                translation = (move["x"], move["y"], move["z"])
                rotation = (turn["x"], turn["y"], turn["z"], turn["w"])
                names = value["header"]["frame_id"].lstrip("/"), value["child_frame_id"].lstrip("/")
                found.append(_Link(message.t_ns, *names, translation, rotation, topic == "/tf_static"))
    return sorted(found, key=lambda each: each.t_ns)


def _poses(
    expectation: Expectation, evidence: Evidence, links: Sequence[_Link], direct: Sequence[_Link]
) -> list[tuple[int, Vector, Quaternion]]:
    """Return where the frame is: each time that it is sent, or each half second where frames lie between."""
    if expectation.at_s is None and direct:
        return [(transform.t_ns, transform.translation, transform.rotation) for transform in direct]
    from_ns, until_ns = round(expectation.from_s * NS_PER_S), round(evidence.until_s(expectation) * NS_PER_S)
    times = (
        range(from_ns, until_ns + 1, _STEP_NS)
        if expectation.at_s is None
        else [round(expectation.at_s * NS_PER_S)]
    )
    last: dict[str, list[_Link]] = {}
    for link in links:
        last.setdefault(link.child, []).append(link)
    poses = ((t_ns, _looked_up(last, expectation, t_ns)) for t_ns in times)
    return [(t_ns, *pose) for t_ns, pose in poses if pose is not None]


def _looked_up(
    links: dict[str, list[_Link]], expectation: Expectation, t_ns: int
) -> tuple[Vector, Quaternion] | None:
    """Return the transform from the frame up to the parent at a time; None where they are not connected."""
    name, translation, rotation = expectation.target, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    for _ in range(_MOST_LINKS):
        if name == expectation.parent:
            return translation, rotation
        own = links.get(name, ())
        index = bisect_right([transform.t_ns for transform in own], t_ns)
        if not index:
            return None
        link = own[index - 1]
        moved = _turned(translation, link.rotation)
        x, y, z = (a + b for a, b in zip(moved, link.translation, strict=True))
        translation, rotation, name = (x, y, z), _product(link.rotation, rotation), link.parent
    return None


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _turned(vector: Vector, by: Quaternion) -> Vector:
    x, y, z, _ = _product(_product(by, (*vector, 0.0)), (-by[0], -by[1], -by[2], by[3]))
    return x, y, z


def _where(
    expectation: Expectation, evidence: Evidence, poses: Sequence[tuple[int, Vector, Quaternion]]
) -> tuple[float, Text, Reason, Text]:
    """Return at which share of the times the frame is where it should be, where it first is not, and should be."""
    good, first, should = 0, EMPTY, EMPTY
    worst = -1.0
    why: Reason = unknown
    for n, (t_ns, translation, rotation) in enumerate(poses):
        names = evidence.names(t_ns, n=n)
        place = wanted_of(expectation.translation, names) if expectation.translation is not None else None
        turn = _wanted_turn(expectation, names)
        far = place is not None and not _near(place, translation, expectation.within)
        askew = turn is not None and not _angle_deg(turn, rotation) <= expectation.within_deg
        good += not (far or askew)
        error = _angle_deg(turn, rotation) if turn is not None and askew and not far else -1.0
        if error > worst:
            worst, why = error, partial(_askew, expectation, turn, rotation)
        if (far or askew) and first == EMPTY:
            told = f"({', '.join(f'{each:.2f}' for each in translation)}), yaw {_yaw_deg(rotation):.1f}°"
            time = f"{t_ns / NS_PER_S:.1f}"
            first = say("expected.frame", time=time, place=told)
            should = _should(expectation, place, turn)
    return good / len(poses), first, why, should


def _should(expectation: Expectation, place: Any, turn: Quaternion | None) -> Text:
    """Say where a frame should be at one time."""
    parts = [f"{expectation.parent} → {expectation.target}"]
    if isinstance(place, list) and all(isinstance(coordinate, int | float) for coordinate in place):
        parts.append(f"({', '.join(f'{each:.2f}' for each in place)})")
    if turn is not None and math.isfinite(turn[3]):
        parts.append(f"yaw {_yaw_deg(turn):.1f}°")
    return plain("; ".join(parts))


def _near(place: Any, translation: Vector, within: float) -> bool:
    numbers = isinstance(place, list) and all(isinstance(coordinate, int | float) for coordinate in place)
    return numbers and round(exact.apart(place, translation), 9) <= within


def _wanted_turn(expectation: Expectation, names: dict[str, Any]) -> Quaternion | None:
    if expectation.rotation is not None:
        wanted = wanted_of(list(expectation.rotation), names)
        if not isinstance(wanted, list) or not all(
            isinstance(coordinate, int | float) for coordinate in wanted
        ):
            return math.nan, math.nan, math.nan, math.nan
        x, y, z, w = map(float, wanted)
        return x, y, z, w
    if expectation.yaw_deg is None:
        return None
    yaw = wanted_of(expectation.yaw_deg, names)
    half = math.radians(yaw) / 2.0 if isinstance(yaw, int | float) else math.nan
    cos, sin = exact.cos_sin(half)
    return 0.0, 0.0, sin, cos


def _angle_deg(one: Quaternion, other: Quaternion) -> float:
    """Return the angle between two rotations; infinite where one is none."""
    lengths = exact.length(one) * exact.length(other)
    if not math.isfinite(lengths) or not 0.5 < exact.length(other) < 2.0 or lengths == 0.0:
        return math.inf
    dot = min(abs(exact.total(a * b for a, b in zip(one, other, strict=True))) / lengths, 1.0)
    return round(math.degrees(2.0 * exact.atan2(math.sqrt(1.0 - dot * dot), dot)), 4)


def _yaw_deg(rotation: Quaternion) -> float:
    x, y, z, w = rotation
    return math.degrees(exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))


def _askew(expectation: Expectation, turn: Quaternion | None, rotation: Quaternion) -> Mistake | None:
    """Return that what a frame is turned by is no quaternion: an angle stands in it."""
    yaw = 0.0 if turn is None else math.radians(_yaw_deg(turn))
    is_angle = abs(rotation[2] - yaw) < 0.05 and abs(yaw) > 0.2
    if turn is None or (0.9 < exact.length(rotation) < 1.1 and not is_angle):
        return None
    return mistake("frame_no_quaternion", frame=expectation.target, length=f"{exact.length(rotation):.2f}")


def _missing(expectation: Expectation, links: Sequence[_Link]) -> Mistake:
    pairs = {(link.parent, link.child) for link in links}
    if (expectation.target, expectation.parent) in pairs:
        return mistake("frame_swapped", frame=expectation.target, parent=expectation.parent)
    used = named(f"{parent} → {child}" for parent, child in sorted(pairs))
    return mistake("frame_missing", frame=expectation.target, parent=expectation.parent, used=used)


def _wanted_text(expectation: Expectation) -> Text:
    parts = [plain(f"{expectation.parent} → {expectation.target}")]
    if expectation.translation is not None:
        parts.append(
            plain(f"({', '.join(str(coordinate).lstrip('= ') for coordinate in expectation.translation)})")
        )
    if expectation.yaw_deg is not None:
        parts.append(plain(f"yaw {str(expectation.yaw_deg).lstrip('= ')}°"))
    if expectation.rotation is not None:
        parts.append(
            plain(f"[{', '.join(str(component).lstrip('= ') for component in expectation.rotation)}]")
        )
    if expectation.rate_hz is not None:
        parts.append(plain(f"{expectation.rate_hz:g} Hz"))
    return join(parts, _AND)
