"""Why a mistake happened: the line of the script that should be changed.

A check knows only what the car did, and a mistake's code says no more: *sides missing*, *only stops*. Often one
line of the script explains it. `with_causes` then puts that cause in the mistake's place. Each cause names the
mistakes that it can lead to, so a line that did no harm is never mentioned. Where the script does not show the
cause for certain, the mistake stays as it was.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from grader.checks.causes import counts, flow, given, numbers, steering, ticks, times
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
_LASTS: Final = frozenset(
    ("endless_turn", "wall_hit", "piece_never_ends", "turned_instead", "turned_too", "never_stops")
)
_TIMED: Final = (
    _STUCK
    | _NO_MOTION
    | _SHORT
    | _COUNT
    | _CORNERS
    | _LENGTHS
    | _LASTS
    | {"too_brief", "drives_too_brief", "stopped_at_once", "stop_in_loop"}
)
"""Mistakes that a motion of the wrong length may cause."""
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
_WRONG_WAY: Final = frozenset(("place_away", "place_lost", "place_circled", "place_missed", "place_wall"))
_COUNTED: Final = (
    _STUCK | _NO_MOTION | _COUNT | _LOST | {"endless_turn", "never_stops", "turned_instead", "wall_hit"}
)
"""Mistakes that a count or a state that never changes may cause."""
_TURNED_LONG: Final = frozenset(("endless_turn", "turns_too_far", "too_slow"))
_TOO_FAR: Final = frozenset(("wall_hit", "turns_behind_loop"))
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
    (_COUNTED, counts.set_to_plus),
    (_COUNTED | _BY_POSE | {"curved"}, flow.state_never_set),
    (_STUCK | _NO_MOTION | {"turned_instead", "endless_turn", "never_stops"}, flow.compared_only),
    (_STUCK | _TURNED_LONG | _TOO_FAR | {"place_never_stops"}, ticks.sleeps_in_callback),
    (_STUCK | _TOO_FAR | {"endless_turn", "no_turns"}, ticks.ticks_too_long),
    (_BY_POSE | _COUNT | {"wall_hit"}, steering.equals_exactly),
    (_BY_POSE | _CORNERS | _COUNT | {"endless_turn", "degrees_as_radians"}, steering.degrees_added),
    (_NO_MOTION | _LOST | {"never_stops", "wall_hit", "side_goes_on", "endless_turn"}, flow.deaf_loop),
    (_STUCK | _NO_MOTION | _BY_POSE | _SILENT | _WAITS, flow.kept_local),
    (_NO_MOTION | _LOST | _SILENT | _BY_POSE | _WAITS, flow.kept_global),
    (_NO_MOTION | _LOST | _SILENT | _WAITS, flow.thread_runs_here),
    (_NO_MOTION | _SILENT | _BY_POSE | _WAITS | {"never_spun", "stalled"}, flow.thread_not_started),
    (_NO_MOTION | _SILENT, flow.never_filled),
    (_TIMED, times.nanoseconds_unit),
    (_TIMED, times.not_seconds),
    (_TIMED, times.start_anew_each_tick),
    (_SHORT | _COUNT | {"no_turns", "unequal_sides", "one_corner_off", "drives_too_brief"}, times.start_kept),
    (_STUCK | _NO_MOTION | _LASTS, times.start_anew),
    (_STUCK | _LASTS, times.reversed_time),
    (_CORNERS | {"unequal_sides", "wrong_lengths"}, times.whole_seconds),
    (frozenset(("turns_too_far",)), times.no_stop_between),
    (_NO_MOTION | {"published_once", "too_brief", "stopped_at_once"}, times.publish_behind_loop),
    (_NO_MOTION | _SHORT | {"too_brief", "drives_too_brief"}, times.sleep_behind_loop),
    (_NO_MOTION | _SHORT, numbers.floor_is_zero),
    (_NO_MOTION | _SHORT, numbers.int_is_zero),
    (_NO_MOTION | _COUNT, numbers.negative_time),
    (_NO_MOTION | _SHORT, times.clock_before_sleep),
    (_SHORT | _NO_MOTION | _COUNT | {"turned_instead"}, times.start_once),
    (_NO_MOTION, times.since_1970),
    (_NO_MOTION, times.waits_for_past),
    (_NO_MOTION | {"never_stops", "endless_turn"}, counts.count_anew),
    (_COUNT | _SHORT | {"drives_too_brief", "too_brief", "no_turns"}, flow.leaves_loop),
    (frozenset(("sides_missing", "sides_missing_by_timer")), counts.count_kept),
    (_NO_MOTION, flow.empty_function),
    (_NO_MOTION | _SILENT | {"never_spun"}, flow.never_called),
    (_SHORT | _CORNERS | {"path_count"}, numbers.radians_twice),
    (_SHORT | _CORNERS | _LOST | {"no_drive_by_pose"}, numbers.radians_of_pose),
    (
        frozenset(("endless_turn", "turns_too_far", "degrees_as_radians", "turned_instead")),
        numbers.degrees_for_radians,
    ),
    (
        _CORNERS | _LOST | {"degrees_as_radians", "no_drive_by_pose", "side_goes_on", "place_wall"},
        numbers.degrees_of_radians,
    ),
    (_LOST | _WRONG_WAY | {"no_drive_by_pose"}, steering.quaternion_for_yaw),
    (_WRONG_WAY | {"side_goes_on", "swings"}, steering.arctan_exchanged),
    (_LOST | _WRONG_WAY | {"no_drive_by_pose", "turned_instead"}, steering.turns_away),
    (_WRONG_WAY, steering.away_from_goal),
    (frozenset(("place_never_stops", "place_circled")), steering.tolerance_too_small),
    (steering.LATER | {"turns_too_short", "one_corner_off", "slipped"}, steering.wide_tolerance),
    (_CORNERS | _COUNT | {"no_turns", "wall_hit", "curved", "arcs"}, flow.timers_overrule),
    (_CORNERS - {"one_radian"}, times.wrong_time),
    (_SHORT | {"one_corner_off"}, numbers.ticks_cut),
    (_SHORT | {"no_turns", "too_brief", "turned_instead"}, ticks.count_not_reset),
    (_SHORT | _COUNT | {"unequal_sides", "drives_too_brief", "turned_instead"}, ticks.sum_not_reset),
    (_SHORT, ticks.counts_ticks),
    (_COUNT | {"too_slow"}, times.sleeps_on),
    (_COUNT, flow.removes_in_loop),
    (_COUNT | {"no_turns"}, flow.skips_rest),
    (_STUCK | {"no_turns", "no_drive"}, flow.branch_without_publish),
    (frozenset(("no_turns", "no_drive", "only_stops")), flow.never_sent),
    (_COUNT, times.timer_ends),
    (_COUNT, flow.no_loop),
    (_LENGTHS | _CORNERS | _COUNT | {"turned_instead", "wall_hit", "arcs"}, flow.timer_repeats),
    (_LENGTHS | _CORNERS | _COUNT | {"other_figure"}, counts.always_true),
    (
        _LENGTHS
        | _STUCK
        | {"never_stops", "sides_extra", "drove_on", "turned_on", "endless_turn", "piece_never_ends"},
        counts.counter_unchanged,
    ),
    (frozenset(("one_corner_off", "unequal_sides", "turns_too_far")), counts.grows),
    (_NO_MOTION | _SILENT | {"no_input", "exited_early"}, given.whole_only),
    (_SILENT | {"exited_early"}, given.int_refuses),
    (frozenset(("none_in_sum", "still_none", "crashed")), given.no_default),
    (frozenset(("wrong_lengths",)), given.rounded),
    (frozenset(("wrong_lengths",)), given.clamped),
    (frozenset(("wrong_lengths",)), given.parameter_default),
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
