"""One client's subscription to one topic: how it wants messages, and when the next one is due."""

import math
from dataclasses import dataclass, field
from typing import Final

from grader.sim.rosbridge.frames import FrameError, Identity, Subscribe

USUAL_DEPTH: Final = 10
MOST_DEPTH: Final = 100
MOST_IDS: Final = 20
LEAST_FRAGMENT: Final = 128
_NS_PER_MS: Final = 1_000_000


@dataclass(slots=True)
class _Wish:
    """One ``subscribe``: pause between messages, messages kept, characters of a fragment (0: whole messages)."""

    throttle_ns: int
    depth: int
    fragment: int


@dataclass(slots=True)
class Subscription:
    """All that a client asked for on one topic, under any number of ids: the least pause and size win.

    Attributes:
        slot: under which number its messages wait for a reader.
        depth: how many of them wait; of more, the oldest are dropped.
        fragment: most characters of a part of a frame; 0: frames are sent whole.
    """

    slot: int
    depth: int = USUAL_DEPTH
    fragment: int = 0
    _throttle_ns: int = 0
    _due_ns: int = 0
    _wishes: dict[Identity, _Wish] = field(default_factory=dict)

    def add(self, frame: Subscribe) -> None:
        """Take one more wish. Raises FrameError: there are too many ids, or the fragments are too small."""
        fragment = int(frame.fragment_size or 0)
        if 0 < fragment < LEAST_FRAGMENT:
            raise FrameError(f"fragment_size: at least {LEAST_FRAGMENT}", frame.id)
        if frame.id not in self._wishes and len(self._wishes) >= MOST_IDS:
            raise FrameError(f"{frame.topic}: at most {MOST_IDS} subscriptions of one client", frame.id)
        depth = min(int(frame.queue_length or USUAL_DEPTH), MOST_DEPTH)
        throttle_ns = round((frame.throttle_rate or 0.0) * _NS_PER_MS)
        self._wishes[frame.id] = _Wish(throttle_ns, max(depth, 1), fragment)
        self._decide()

    def remove(self, identity: Identity) -> bool:
        """Drop the wish of that id, or all of them for None; return whether none is left.

        An unknown id changes nothing, as in rosbridge.
        """
        if identity is None:
            self._wishes.clear()
        elif identity in self._wishes:
            del self._wishes[identity]
            self._decide()
        return not self._wishes

    def wants(self, t_ns: int) -> bool:
        """Return whether a message of `t_ns` is due, and count the pause from then on, without drifting."""
        if t_ns < self._due_ns:
            return False
        self._due_ns = (
            max(self._due_ns + self._throttle_ns, t_ns - self._throttle_ns) if self._throttle_ns else 0
        )
        if self._throttle_ns and self._due_ns <= t_ns:
            self._due_ns = t_ns + self._throttle_ns
        return True

    def _decide(self) -> None:
        wishes = self._wishes.values()
        self._throttle_ns = min((wish.throttle_ns for wish in wishes), default=0)
        self.depth = min((wish.depth for wish in wishes), default=USUAL_DEPTH)
        fragments = [wish.fragment or math.inf for wish in wishes]
        least = min(fragments, default=math.inf)
        self.fragment = 0 if math.isinf(least) else int(least)
        self._due_ns = 0
