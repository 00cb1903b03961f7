"""The tree of frames: what tf2's buffer_core.cpp does (ROS 2 Humble), with its texts."""

from __future__ import annotations

import sys
from typing import Any

from tf2_py._algebra import IDENTITY, Rigid
from tf2_py._cache import StaticCache, TimeCache
from tf2_py._exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from tf2_py._poses import from_message, problems, to_message, to_ns

_CACHE_TIME_NS = 10 * 10**9
_MAX_DEPTH = 1000
_SHORTEST_NS = 100_000  # span of time for which the rate of a single pose is told
_LOOP = "The tf tree is invalid because it contains a loop."

Cache = TimeCache | StaticCache


class BufferCore:
    """Poses of frames in their parents, and the transforms that follow from them.

    Args:
        cache_time: how long the poses of a moving frame are kept (10 s when left out).
    """

    def __init__(self, cache_time: Any = None) -> None:
        self._span_ns = _CACHE_TIME_NS if cache_time is None else to_ns(cache_time)
        self._caches: dict[str, Cache] = {}
        self._frames: dict[str, None] = {}
        self._authorities: dict[str, str] = {}

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a pose of a moving frame. A malformed one is ignored, with a line on stderr."""
        self._insert(transform, authority, static=False)

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Set the pose of a fixed frame."""
        self._insert(transform, authority, static=True)

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return the pose of `source_frame` in `target_frame` as a TransformStamped.

        Raises TransformException: its subclass tells why there is none.
        """
        _require_names(_1=target_frame, _2=source_frame)
        rigid, time_ns = self._lookup(target_frame, source_frame, to_ns(time), "lookupTransform")
        return to_message(rigid, time_ns, target_frame, source_frame)

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """Return the pose of `source_frame` then in `target_frame` now, by way of a frame fixed in time.

        Raises TransformException: its subclass tells why there is none.
        """
        _require_names(_1=target_frame, _3=source_frame, _5=fixed_frame)
        self._validate(target_frame, "lookupTransform argument target_frame")
        self._validate(source_frame, "lookupTransform argument source_frame")
        self._validate(fixed_frame, "lookupTransform argument fixed_frame")
        then, _ = self._lookup(fixed_frame, source_frame, to_ns(source_time), "lookupTransform")
        now, time_ns = self._lookup(target_frame, fixed_frame, to_ns(target_time), "lookupTransform")
        return to_message(now @ then, time_ns, target_frame, source_frame)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[bool, str]:
        """Return whether the transform is known, and why not."""
        _require_names(_1=target_frame, _2=source_frame)
        try:
            self._lookup(target_frame, source_frame, to_ns(time), "canTransform")
        except TransformException as error:
            return False, str(error)
        return True, ""

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[bool, str]:
        """Return whether the transform by way of a fixed frame is known, and why not."""
        _require_names(_1=target_frame, _3=source_frame, _5=fixed_frame)
        try:
            self._validate(target_frame, "canTransform argument target_frame")
            self._validate(source_frame, "canTransform argument source_frame")
            self._validate(fixed_frame, "canTransform argument fixed_frame")
        except TransformException as error:
            return False, str(error)
        known, why = self.can_transform_core(target_frame, fixed_frame, target_time)
        return self.can_transform_core(fixed_frame, source_frame, source_time) if known else (known, why)

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Any:
        """Return the newest time at which both frames are known. Raises TransformException: there is none."""
        from rclpy.time import Time

        for name in (target_frame, source_frame):
            if name not in self._frames:
                raise LookupException("One of the frames does not exist")
        return Time(nanoseconds=self._latest_common_ns(target_frame, source_frame))

    def clear(self) -> None:
        """Forget the poses of all moving frames; fixed ones stay, as upstream."""
        self._caches = {name: cache for name, cache in self._caches.items() if isinstance(cache, StaticCache)}

    def all_frames_as_string(self) -> str:
        """Return one sentence per frame that has a parent."""
        return "".join(
            f"Frame {frame} exists with parent {cache.latest.parent}.\n"
            for frame, cache in self._caches.items()
        )

    def all_frames_as_yaml(self) -> str:
        """Return parent, authority, rate and times of every frame as YAML."""
        if not self._frames:
            return "[]"
        lines = ""
        for frame, cache in self._caches.items():
            length_ns = cache.latest_ns - cache.oldest_ns
            lines += f"{frame}: \n  parent: '{cache.latest.parent}'\n"
            lines += f"  broadcaster: '{self._authorities[frame]}'\n"
            lines += f"  rate: {cache.length * 1e9 / max(length_ns, _SHORTEST_NS):.3f}\n"
            lines += f"  most_recent_transform: {cache.latest_ns / 1e9:.6f}\n"
            lines += f"  oldest_transform: {cache.oldest_ns / 1e9:.6f}\n"
            lines += f"  buffer_length: {length_ns / 1e9:.3f}\n"
        return lines

    def _frameExists(self, frame_id: str) -> bool:
        return frame_id in self._frames

    def _getFrameStrings(self) -> list[str]:
        return list(self._frames)

    def _insert(self, transform: Any, authority: str, static: bool) -> None:
        sample = from_message(transform)
        child = transform.child_frame_id.removeprefix("/")
        wrong = problems(child, sample, authority)
        for line, text in wrong:
            _complain("Error:   ", text, line)
        if wrong:
            return
        cache = self._caches.get(child)
        if cache is None or isinstance(cache, StaticCache) is not static:
            cache = StaticCache() if static else TimeCache(self._span_ns)
        if not cache.insert(sample):
            _complain(
                "Warning: ",
                f"TF_OLD_DATA ignoring data from the past for frame {child} at time "
                f"{sample.stamp_ns / 1e9:.6f} according to authority {authority}\n"
                "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
                294,
            )
            return
        self._caches[child] = cache
        self._frames |= {child: None, sample.parent: None}
        self._authorities[child] = authority

    def _lookup(self, target: str, source: str, time_ns: int, caller: str) -> tuple[Rigid, int]:
        """Return the transform from `source` to `target` and the time it belongs to."""
        if target == source:
            cache = self._caches.get(target)
            return IDENTITY, cache.latest_ns if cache is not None and time_ns == 0 else time_ns
        self._validate(target, f"{caller} argument target_frame")
        self._validate(source, f"{caller} argument source_frame")
        if time_ns == 0:
            time_ns = self._latest_common_ns(target, source)
        up, top, reason = self._walk(source, time_ns, {target})
        down, end, failed = self._walk(target, time_ns, {top, source}) if top != target else ([], top, None)
        if end == source:
            return _chain(down).inverse(), time_ns
        if failed is not None or (end != top and reason is not None):
            raise ExtrapolationException(
                f"{failed or reason}, when looking up transform from frame [{source}] to frame [{target}]"
            )
        if end != top:
            raise _unconnected(target, source)
        return _chain(down).inverse() @ _chain(up), time_ns

    def _validate(self, frame: str, argument: str) -> None:
        looking_up = argument.startswith("lookup")
        for wrong, why in (
            (not frame, "cannot be empty"),
            (frame.startswith("/"), "cannot start with a '/'"),
        ):
            if wrong:
                what = "Invalid argument" if looking_up else "Invalid frame ID"
                raise InvalidArgumentException(
                    f'{what} "{frame}" passed to {argument} - in tf2 frame_ids {why}'
                )
        if frame not in self._frames:
            if looking_up:
                raise LookupException(f'"{frame}" passed to {argument} does not exist. ')
            raise LookupException(f'Invalid frame ID "{frame}" passed to {argument} - frame does not exist')

    def _walk(
        self, frame: str, time_ns: int, stops: set[str]
    ) -> tuple[list[Rigid], str, ExtrapolationException | None]:
        """Climb from `frame` to a stop, the root, or a frame without a pose at that time, with the reason."""
        rigids: list[Rigid] = []
        while frame not in stops and frame in self._caches:
            try:
                sample = self._caches[frame].at(time_ns)
            except ExtrapolationException as error:
                return rigids, frame, error
            rigids.append(sample.rigid)
            frame = sample.parent
            if len(rigids) > _MAX_DEPTH:
                raise LookupException(f"{_LOOP}\n{self.all_frames_as_string()}\n")
        return rigids, frame, None

    def _latest_common_ns(self, target: str, source: str) -> int:
        """Return the newest time at which every frame on the way is known; 0 when none of them moves."""
        ancestors = self._ancestors(source, target)
        stamps: list[int] = []
        if target not in ancestors:
            common = None
            for frame in self._ancestors(target, source):
                common = frame
                if frame in ancestors:
                    break
            if common not in ancestors:
                raise _unconnected(target, source)
            stamps += self._stamps(target, common)
            stamps += self._stamps(source, common)
        else:
            stamps += self._stamps(source, target)
        return min((stamp for stamp in stamps if stamp != 0), default=0)

    def _ancestors(self, frame: str, stop: str) -> list[str]:
        """Return `frame` and the frames above it, up to `stop` or the root, as of their latest poses."""
        frames = [frame]
        while frames[-1] != stop and frames[-1] in self._caches:
            frames.append(self._caches[frames[-1]].latest.parent)
            if len(frames) > _MAX_DEPTH:
                raise LookupException(f"{_LOOP}\n{self.all_frames_as_string()}\n")
        return frames

    def _stamps(self, frame: str, end: str) -> list[int]:
        return [self._caches[name].latest_ns for name in self._ancestors(frame, end) if name != end]


def _complain(level: str, text: str, line: int) -> None:
    sys.stderr.write(f"{level}{text}\n         at line {line} in ./src/buffer_core.cpp\n")


def _require_names(**frames: Any) -> None:
    """Raise TypeError, as the C module does, for a frame that is no text."""
    for position, frame in frames.items():
        if not isinstance(frame, str):
            kind = "None" if frame is None else type(frame).__name__
            raise TypeError(f"argument {position[1:]} must be str, not {kind}")


def _chain(rigids: list[Rigid]) -> Rigid:
    total = IDENTITY
    for rigid in rigids:
        total = rigid @ total
    return total


def _unconnected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part of the "
        "same tree.Tf has two or more unconnected trees."
    )
