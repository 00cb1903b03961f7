"""Why a mistake happened: the line of the script that should be changed.

A check knows only what the car did, and a mistake's code says no more: *sides missing*, *only stops*. Often one
line of the script explains it. `with_causes` then puts that cause in the mistake's place. Each cause names the
mistakes that it can lead to, so a line that did no harm is never mentioned. Where the script does not show the
cause for certain, the mistake stays as it was.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from grader.checks.causes import flow
from grader.checks.causes.searched import Searched
from grader.checks.measure import Findings, Mistake
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.messages.script import ScriptText

_NO_MOTION: Final = frozenset(
    (
        "only_stops",
        "only_stops_by_pose",
        "only_stops_heard",
        "no_turns",
        "no_turns_by_pose",
        "zero_commands",
        "no_drive",
        "no_drive_by_pose",
    )
)
_STUCK: Final = frozenset(("side_never_ends",))
_SILENT: Final = frozenset(
    ("never_published", "publish_not_reached", "nothing_ran", "only_printed", "ended_before_init")
)
_SHORT_TURN: Final = frozenset(("turn_too_short", "turned_one_radian", "half_turn", "turn_too_slow"))
_SHORT: Final = _SHORT_TURN | {"too_short", "turns_too_short", "one_radian"}
_COUNT: Final = frozenset(("sides_missing", "sides_missing_by_timer", "path_count", "path_unfinished"))
_LENGTHS: Final = frozenset(("wrong_lengths", "unequal_sides"))
_CORNERS: Final = frozenset(("turns_too_short", "turns_too_far", "one_corner_off", "one_radian"))
_LOST: Final = frozenset(
    (
        "place_away",
        "place_lost",
        "place_circled",
        "place_missed",
        "place_too_slow",
        "place_never_stops",
        "endless_turn_by_pose",
        "never_finished",
        "swings",
    )
)
_COUNTED: Final = (
    _STUCK | _NO_MOTION | _COUNT | _LOST | {"endless_turn", "never_stops", "turned_instead", "wall_hit"}
)
"""Mistakes that a count or a state that never changes may cause."""
_BY_POSE: Final = _LOST | {"side_goes_on", "turned_instead", "no_turns", "no_turns_by_pose"}
"""Mistakes that a wrong comparison with a pose may cause."""
_NOT_ON: Final = frozenset(("not_spinning", "never_spun"))
_WAITS: Final = frozenset(("waits_in_loop", "waits_without_spin"))
_KEPT_BUSY: Final = frozenset(("waits_in_loop", "cpu_limit", "log_not_reached", "publish_not_reached"))
_LEFT_OUT: Final = (
    _NO_MOTION
    | _COUNT
    | _STUCK
    | {"no_final_stop", "never_stops", "drove_on", "turned_on", "turn_missing", "never_finished"}
    | {"too_short", "turn_too_short", "turns_too_far"}
)
"""Mistakes that may come of lines that did not run."""
_CAUSES: Final[tuple[tuple[frozenset[str], Callable[[Searched], Mistake | None]], ...]] = (
    (_LEFT_OUT, flow.error_hides_rest),
    (_NO_MOTION | {"wall_hit_in_arc", "path_no_arc", "path_count", "path_unfinished"}, flow.other_axis),
    (_COUNTED | _BY_POSE | {"curved"}, flow.state_never_set),
    (_STUCK | _NO_MOTION | {"turned_instead", "endless_turn", "never_stops"}, flow.compared_only),
    (_NO_MOTION | _LOST | {"never_stops", "wall_hit", "side_goes_on", "endless_turn"}, flow.deaf_loop),
    (_STUCK | _NO_MOTION | _BY_POSE | _SILENT | _WAITS, flow.kept_local),
    (_NO_MOTION | _LOST | _SILENT | _BY_POSE | _WAITS, flow.kept_global),
    (_NO_MOTION | _LOST | _SILENT | _WAITS, flow.thread_runs_here),
    (_NO_MOTION | _SILENT | _BY_POSE | _WAITS | {"never_spun", "stalled"}, flow.thread_not_started),
    (_NO_MOTION | _SILENT, flow.never_filled),
    (_COUNT | _SHORT | {"drives_too_brief", "too_brief", "no_turns"}, flow.leaves_loop),
    (_NO_MOTION, flow.empty_function),
    (_NO_MOTION | _SILENT | {"never_spun"}, flow.never_called),
    (_CORNERS | _COUNT | {"no_turns", "wall_hit", "curved", "arcs"}, flow.timers_overrule),
    (_COUNT, flow.removes_in_loop),
    (_COUNT | {"no_turns"}, flow.skips_rest),
    (_STUCK | {"no_turns", "no_drive"}, flow.branch_without_publish),
    (frozenset(("no_turns", "no_drive", "only_stops")), flow.never_sent),
    (_COUNT, flow.no_loop),
    (_LENGTHS | _CORNERS | _COUNT | {"turned_instead", "wall_hit", "arcs"}, flow.timer_repeats),
    (frozenset(("stopped_at_once", "too_brief", "stop_in_loop")), flow.timer_stops),
    (_NOT_ON | {"no_turns", "too_short", "turn_too_short"}, flow.spin_once),
    (_NOT_ON, flow.ends_in_callback),
    (frozenset(("log_not_reached",)), flow.level_raised),
    (frozenset(("log_not_reached",)), flow.log_behind_spin),
    (frozenset(("log_not_reached",)), flow.long_period),
    (
        _NO_MOTION
        | _COUNT
        | {
            "stopped_at_once",
            "log_not_reached",
            "no_final_stop",
            "never_stops",
            "drove_on",
            "turned_on",
            "turn_missing",
        },
        flow.uncalled,
    ),
    (frozenset(("wrong_topic",)), flow.lookalike),
    (frozenset(("never_published",)), flow.no_publish),
    (frozenset(("never_published", "publish_not_reached")), flow.long_period),
    (frozenset(("publisher_not_reached", "log_not_reached")), flow.class_not_made),
    (frozenset(("publish_not_reached",)), flow.returns_before),
    (frozenset(("publish_not_reached",)), flow.lambda_names),
    (_WAITS, flow.waits_for_two),
    (_KEPT_BUSY, flow.loop_for_spin),
)
"""Mistakes, each with a function that looks for a cause of them; the first cause that is found counts."""


def with_causes(assignment: Assignment, run: Run, findings: Findings) -> Findings:
    """Return the findings with each mistake replaced by the cause that the script shows, where it shows one."""
    script = ScriptText(run.source)
    if not script.is_short:
        return findings
    causes = tuple(_cause(Searched(assignment, run, script, findings, each)) for each in findings.mistakes)
    return replace(findings, mistakes=causes)


def _cause(seen: Searched) -> Mistake:
    for codes, look in _CAUSES:
        if seen.mistake.code in codes and (cause := look(seen)) is not None:
            return Mistake(cause.code, cause.text, seen.mistake.measures, seen.mistake.apart)
    return seen.mistake
