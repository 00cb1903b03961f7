"""What kinds of causes there are, so that a hint may be worded otherwise and still be right.

``error``: Python says it. ``silent``: a part of the script, or all of it, came to nothing: it did not run, was
not sent or not obeyed. ``size``: a turn, a side or a count that is too large or too small, a script that is too
slow. ``shape``: where or how the car drove. ``stop``: how the drive ended. ``task``: the input, a service, or the
exercise itself. What the car did may have causes of two kinds: it never turned because the line did not run, or
because its turns were too small.
"""

import re
from typing import Final

KINDS: Final = {
    kind: frozenset(codes.split())
    for kind, codes in {
        "silent": """
            alive always_true deaf_callback deaf_loop empty_loop error_caught
            frozen_loop held
            incompatible_qos info_logs init_without_node killed listens_nowhere
            listens_other_quality never_called never_logged never_published never_spun never_true no_drive
            no_publisher no_turns nodes not_received not_spinning nothing_ran nothing_sent
            only_printed only_stops period printed
            publishes_at_other_times publishes_nothing publishes_nowhere sensor_qos
            service_nowhere sideways sleeps sleeps_too_long stalled stopped_at_once swings
            set_anew thread_crashed timer_in_callback too_brief topic_nowhere true_at_start turtle_killed
            two_spins types_differ unfinished unheard waits_before wrong_topic wrong_type
        """,
        "size": """
            advance_m corner_deg cpu_limit degrees_as_radians detour_pct drove drove_plain endless_loop
            heading_error_deg in_line interior_angle length_error_pct missed_m no_turns one_radian
            one_axis output_limit period published_once radius radius_error_pct rate_radps reached reached_pct
            rotation_absolute same_twice side_error_pct side_spread_pct sides sleeps time_s time_was_up too_brief
            too_large too_slow touch_pct turn_radps turned turned_deg turned_plain
        """,
        "shape": """
            advance_m alternates arc band_m band_pct contended corner_error_deg covered_pct curved_pct drift_m
            gap_pct in_line jolt_mps lateral_pct line_covered_pct line_pct mean_off_pct moving_s no_arc_spins
            no_arc_straight no_drive off_pct one_axis same_twice
            open_loop opposite_corners other_side place_hit place_order place_wall
            room_hit rotation_absolute round_pct sideways speed_mps swings turned_deg unasked unfolded wall_hit
            way_back_m
        """,
        "stop": """
            ahead_m begins_again clearance_m contacts end_off_m endless_loop no_stop overwritten
            place_late place_not_held
            room_hit settled time_was_up
        """,
        "task": """
            argument_ignored asks_again client_missing input_ignored
            known_wrong_answer no_action no_arguments no_number no_service other_name other_type other_unit
            right_in_other_unit service_silent teleported with_unit
        """,
    }.items()
}  # fmt: skip


_LINES: Final = re.compile(r"\b[Ll]ines? (\d+(?:(?:, | and )\d+)*)")


def is_right(category: str, lines: frozenset[int], code: str, sentence: str, *, crashed: bool) -> bool:
    """Whether a hint names one of the expected lines, or at least the expected kind of cause.

    What Python says has a line: there the kind is enough only where no line is expected.
    """
    named = {int(number) for run in _LINES.findall(sentence) for number in re.findall(r"\d+", run)}
    if any(abs(line - other) <= 1 for line in named for other in lines):
        return True
    if crashed:
        return category in ("error", "foreign") and not lines
    return code in KINDS.get(category, ()) or (category == "task" and code.startswith("expected."))
