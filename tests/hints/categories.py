"""What kinds of causes there are, so that a hint may be worded otherwise and still be right.

``error``: Python says it. ``silent``: nothing came of the script, or nothing but stops. ``size``: a turn, a side
or a count that is too large or too small. ``shape``: where or how the car drove. ``stop``: how the drive ended.
``task``: the input, a service or the exercise itself.
"""

import re
from typing import Final

_SIGNS: Final = (
    (
        "stop",
        r"stop(?!_in_loop)|settled|drove_on|turned_on|never_finish|time_was_up|approach|came_back|place_left|laps",
    ),
    (
        "size",
        r"turns?_too|sides_|interior|radian|half_turn|lengths|unequal|corner|too_slow|too_short|too_far|degrees|count|"
        r"length|radius|swept|size|unfinished|too_long|drives?_too|brief|scaled|drove|turned|endless|far|late|early|slow|"
        r"missed|share|sides|spread|advance|covered|no_turns|turn_missing|other_figure|published_once|stop_in_loop",
    ),
    (
        "shape",
        r"arc|curved|kept|wall|zigzag|slipped|crooked|astray|overshot|way|path|place|room|circ|left_|backward|forward|"
        r"sideways|both|too$|fro$|swings|side|instead|drive|contended|long_way|rotation",
    ),
    (
        "task",
        r"ignored|argument|service|answer|agent|tool|goal|frame|slip_|declared|rate_off|message|package|bodies|asks_again",
    ),
)


_LINES: Final = re.compile(r"\b[Ll]ines? (\d+(?:(?:, | and )\d+)*)")


def category_of(code: str, *, crashed: bool) -> str:
    """Return the kind of cause that a code names; of a script that an error ended always ``error``."""
    if crashed:
        return "error"
    return next((name for name, sign in _SIGNS if re.search(sign, code)), "silent")


def is_right(category: str, lines: frozenset[int], code: str, sentence: str, crashed: bool) -> bool:
    """Whether a hint names one of the expected lines, or at least the expected kind of cause."""
    named = {int(number) for run in _LINES.findall(sentence) for number in re.findall(r"\d+", run)}
    near = any(abs(line - other) <= 1 for line in named for other in lines)
    return near or category_of(code, crashed=crashed) == category
