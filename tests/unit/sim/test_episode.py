"""The lockstep loop: what frames do to the world and what comes back."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.contracts.assignment import World
from grader.contracts.conversation import Step
from grader.contracts.record import to_plain
from grader.contracts.trajectory import encode_trajectory, recorded
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.examples import examples
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink
from tests.unit.sim.playing import end_pose, play

MS = 1_000_000


def test_start_says_what_the_world_is(car: Car) -> None:
    link = FakeLink([jail.ended(0)])
    spec = EpisodeSpec(
        world=World(cmd_vel_topic="/cmd_vel", seed=7),
        horizon_ns=SECOND,
        source="print('你好')".encode(),
        file_name="hello.py",
        args=("--fast",),
        stdin="3\n",
        said=(Step(id="go", kind="call", target="/go", type="std_srvs/srv/Trigger"),),
    )
    Episode(spec, car).run(link)
    assert link.source == spec.source
    assert link.start["protocol"] == 6
    assert (link.start["file_name"], link.start["args"], link.start["stdin"]) == (
        "hello.py",
        ["--fast"],
        "3\n",
    )
    assert (link.start["horizon_ns"], link.start["seed"]) == (SECOND, 7)
    world = link.start["world"]
    assert world["subscribes"] == [["/cmd_vel", jail.TWIST]]
    assert ["/turtle1/pose", "turtlesim/msg/Pose"] in world["publishes"]
    assert ["/spawn", "turtlesim/srv/Spawn"] in world["services"]
    assert (world["nodes"], world["calls"]) == (["/turtlesim"], [["/go", "std_srvs/srv/Trigger"]])


def test_a_held_command_drives_its_distance(car: Car) -> None:
    result = play(car, jail.holding([(2.0, 1.0, 0.0)]))
    x, y, turn = end_pose(result)
    assert x == pytest.approx(2.0, abs=1e-4)
    assert abs(y) < 1e-6
    assert abs(turn) < 1e-6
    assert result.violation is None
    assert result.command_count == 101
    assert (result.first_command_ns, result.last_command_ns) == (0, 2 * SECOND)
    assert result.nodes == ("/student",)
    (publisher,) = result.endpoints
    assert (publisher.kind, publisher.name, publisher.count) == ("publisher", "/turtle1/cmd_vel", 101)


def test_one_command_before_the_end_still_drives_for_a_second(car: Car) -> None:
    result = play(
        car, [jail.node(), jail.driver(), jail.publish(2, 5 * MS, jail.twist(1.0)), jail.ended(6 * MS)]
    )
    assert end_pose(result)[0] == pytest.approx(63 * 0.016)
    assert result.duration_ns == 6 * MS
    assert result.trajectory.end_ns > SECOND
    assert result.trajectory.v_mps[-1] == 0.0


def test_a_killed_process_leaves_the_trajectory_up_to_then(car: Car) -> None:
    result = play(car, [jail.node(), jail.driver(), jail.publish(2, SECOND, jail.twist(2.0))])
    assert result.exit is None
    assert result.violation is None
    assert end_pose(result)[0] == pytest.approx(2.0 * 63 * 0.016)


def test_a_command_a_second_keeps_the_car_moving(car: Car) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [jail.publish(2, k * SECOND + k * 2_000, jail.twist(1.0)) for k in range(5)]
    frames += [jail.publish(2, 5 * SECOND, jail.twist()), jail.ended(6 * SECOND)]
    result = play(car, frames)
    assert end_pose(result)[0] == pytest.approx(312 * 0.016)  # the stop comes just before the 313th update


def test_nothing_moves_beyond_the_horizon(car: Car) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [jail.publish(2, t, jail.twist(1.0)) for t in (SECOND // 2, SECOND + 1, 2 * SECOND)]
    result = play(car, [*frames, jail.ended(3 * SECOND, after_interrupt=1)], horizon_s=1.0)
    assert end_pose(result)[0] == pytest.approx(62 * 0.016)
    assert result.trajectory.t_ns[-1] <= SECOND
    assert result.trajectory.end_ns == SECOND
    assert result.command_count == 2
    assert result.duration_ns == SECOND


def test_commands_after_ctrl_c_do_not_put_the_exit_into_the_past(car: Car) -> None:
    # A script with its own SIGINT handler goes on for a moment; its EXIT carries the horizon.
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [jail.publish(2, SECOND + 80_000, jail.twist()), jail.ended(SECOND, after_interrupt=1)]
    result = play(car, frames, horizon_s=1.0)
    assert (result.violation, result.duration_ns, result.command_count) == (None, SECOND, 1)


@pytest.mark.parametrize("said", [jail.note("interrupted"), jail.ended(0, after_interrupt=1)])
def test_ctrl_c_comes_at_the_horizon_whenever_a_script_says_it_came(car: Car, said: bytes) -> None:
    result = play(car, [said], horizon_s=2.0)
    assert (result.duration_ns, result.trajectory.end_ns) == (2 * SECOND, 2 * SECOND)


def test_frames_after_exit_are_not_read(car: Car) -> None:
    result = play(car, [jail.ended(SECOND, code=3), b"\xff"])
    assert result.violation is None
    assert result.exit is not None
    assert result.exit.exit_code == 3


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([b""], "empty frame"),
        ([b"\x99"], "unknown frame kind 0x99"),
        ([jail.publish(9, 0, b"")], "id 9 is not a publisher"),
        ([jail.node(), jail.publish(1, 0, b"")], "id 1 is not a publisher"),
        ([jail.node(), jail.node()], "ENTITY.id 1 is used twice"),
        ([jail.gone(4, 0)], "GONE.id 4"),
        ([jail.driver(), jail.gone(2, 5), jail.publish(2, 6, b"")], "id 2 is not a publisher"),
        ([jail.driver(2, 10), jail.publish(2, 9, b"")], "time went back"),
        ([jail.node(1, 10), jail.advance(9)], "time went back"),
        ([jail.node(1, 10), jail.ended(9)], "time went back"),
        ([jail.driver(), jail.repeat(2, 5)], "REPEAT.id"),
        ([jail.driver(), jail.publish(2, 5, b""), jail.repeat(3, 5)], "REPEAT.id"),
        ([jail.driver(), jail.publish(2, 5, b""), jail.note("a"), jail.repeat(2, 6)], "REPEAT.id"),
        ([jail.driver(), jail.publish(2, 5, b""), jail.repeat(2, 7, 6)], "REPEAT.times go back"),
        ([jail.driver(), jail.publish(2, 5, b""), jail.repeat(2, 4)], "time went back"),
        ([jail.note("Shout!")], "NOTE.code"),
        ([jail.note("started"), jail.ended(0, reason=3)], "EXIT.reason"),
        ([jail.driver(), jail.ended(0, reason=3)], "EXIT.reason"),
        (
            [jail.entity(3, 4, name="/s", type="std_srvs/srv/Trigger"), jail.response(3, 1, 0, b"")],
            "never asked",
        ),
        ([jail.node(identity) for identity in range(8_200)], "more than 8192"),
    ],
)
def test_broken_rules_end_the_belief(car: Car, frames: list[bytes], words: str) -> None:
    result = play(car, [*frames, jail.ended(SECOND)])
    assert result.violation is not None
    assert words in result.violation
    assert result.exit is None


GAPS_NS = st.sampled_from(
    [0, 1_000, 7 * MS, 16 * MS, 50 * MS, 999 * MS, SECOND, SECOND + 16 * MS, 3 * SECOND]
)
TWISTS = st.sampled_from(
    [jail.twist(1.0), jail.twist(), jail.twist(0.0, 1.5), jail.twist(500.0), b"no twist"]
)


@settings(max_examples=examples(60))
@given(st.lists(st.tuples(GAPS_NS, st.sampled_from([2, 3]), TWISTS, st.integers(1, 4)), max_size=12))
def test_repetitions_come_to_the_same_in_one_frame_and_in_many(
    car: Car, drives: list[tuple[int, int, bytes, int]]
) -> None:
    begun = [jail.node(), jail.driver(2), jail.driver(3)]
    single, repeated, t_ns = list(begun), list(begun), 0
    for gap_ns, publisher, twist, times in drives:
        at = [t_ns + gap_ns * number for number in range(1, times + 1)]
        t_ns = at[-1]
        single += [jail.publish(publisher, each, twist) for each in at]
        repeated.append(jail.publish(publisher, at[0], twist))
        if at[1:]:
            repeated.append(jail.repeat(publisher, *at[1:]))
    ended = jail.ended(t_ns)
    results = [play(car, [*frames, ended], horizon_s=8.0) for frames in (single, repeated)]
    one, other = (to_plain(result) for result in results)
    driven = [encode_trajectory(recorded(fields.pop("trajectory"))) for fields in (one, other)]
    assert driven[0] == driven[1]
    assert one == other


def test_the_seed_of_the_rough_cars_noise_is_not_told(car: Car) -> None:
    def told(world: World) -> int:
        link = FakeLink([jail.ended(0)])
        Episode(EpisodeSpec(world=world, horizon_ns=SECOND, source=b"print()", file_name="a.py"), car).run(
            link
        )
        seed = link.start["seed"]
        assert isinstance(seed, int)
        return seed

    assert told(World(seed=5)) == 5
    rough = [told(World(profile="rough", seed=seed)) for seed in (5, 6)]
    assert rough[0] == rough[1]


def test_a_syntax_error_is_believed_as_the_first_frame(car: Car) -> None:
    result = play(car, [jail.ended(0, reason=3)])
    assert result.violation is None
    assert result.exit is not None
    assert result.exit.reason == 3


def test_that_a_script_started_is_no_note_for_the_report(car: Car) -> None:
    result = play(car, [jail.note("started"), jail.ended(0)])
    assert (result.violation, result.notes) == (None, ())


def test_that_a_script_has_threads_is_told_and_no_note_for_the_report(car: Car) -> None:
    told: list[str] = []
    spec = EpisodeSpec(world=World(), horizon_ns=SECOND, source=b"", file_name="a.py")
    frames = [jail.note("started"), jail.note("threads"), jail.ended(0)]
    result = Episode(spec, car).run(FakeLink(frames), on_note=told.append)
    assert (result.notes, told) == ((), ["threads"])


def test_a_violation_keeps_what_was_driven(car: Car) -> None:
    frames = jail.holding([(1.0, 1.0, 0.0)])[:-1]
    result = play(car, [*frames, b"\x00"])
    assert result.violation == "unknown frame kind 0x00"
    assert end_pose(result)[0] == pytest.approx(62 * 0.016)


def speeds_driven(result: EpisodeResult) -> list[tuple[float, int]]:
    """Speeds above zero in the order in which they were driven, and in how many updates each."""
    return [(v, len(list(same))) for v, same in itertools.groupby(result.trajectory.v_mps.tolist()) if v]


def test_each_update_takes_one_command_and_seven_wait(car: Car) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [jail.publish(2, k, jail.twist(k / 10.0)) for k in range(1, 13)]
    result = play(car, [*frames, jail.ended(2 * SECOND)])
    assert speeds_driven(result) == [(k / 10.0, 1) for k in range(6, 12)] + [(1.2, 63)]
    assert result.command_count == 12
    assert [c.v_mps for c in result.trajectory.commands] == [1.2]  # of one update, the last is recorded


def test_a_command_that_is_taken_makes_room_for_another(car: Car) -> None:
    """As in a recording of ten commands at once: an update fell between them, and one was pushed out."""
    frames = [jail.node(), jail.driver()]
    times = [15_999_000 + 200 * k for k in range(1, 11)]  # the fifth comes at the update's very instant
    frames += [jail.publish(2, t, jail.twist(k / 10.0)) for k, t in enumerate(times, 1)]
    result = play(car, [*frames, jail.ended(2 * SECOND)])
    assert speeds_driven(result) == [(0.1, 1)] + [(k / 10.0, 1) for k in range(4, 10)] + [(1.0, 63)]


def test_a_command_is_taken_by_the_first_update_after_it(car: Car) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [jail.publish(2, t, jail.twist(v)) for t, v in ((15_999_999, 1.0), (16_000_000, 2.0))]
    result = play(car, [*frames, jail.ended(2 * SECOND)])
    assert speeds_driven(result) == [(1.0, 1), (2.0, 63)]


def test_commands_faster_than_the_updates_drive_on_by_what_waits(car: Car) -> None:
    (x, _, _) = end_pose(play(car, jail.holding([(2.0, 1.0, 0.0)], every_s=0.01)))
    assert x == pytest.approx(2.096, abs=1e-6)  # so do the recordings t08_lesson


def test_nonsense_commands_are_stops_and_counted(car: Car) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [
        jail.publish(2, SECOND // 2, jail.twist(math.nan, 1.0)),
        jail.publish(2, SECOND, jail.twist(1.0, math.inf)),
    ]
    result = play(car, [*frames, jail.ended(2 * SECOND)])
    assert result.nonfinite_commands == 2
    assert end_pose(result)[0] == pytest.approx(31 * 0.016)
    assert end_pose(result)[2] == 0.0


def test_what_a_car_cannot_do_is_noted(car: Car) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(0.0, 0.0, 1.0))]
    result = play(
        car,
        [*frames, jail.publish(2, 1, jail.twist(1e9)), jail.publish(2, 2, jail.twist()), jail.ended(SECOND)],
    )
    impossible = {"lateral_command", "clamped_command", "stopped_at_once"}
    assert {note.code for note in result.notes} == impossible


def test_unreadable_bytes_on_the_command_topic_do_not_move(car: Car) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [
        jail.publish(2, 1, b""),
        jail.publish(2, 2, jail.twist(1.0)[:-1]),
        jail.publish(2, 3, b"\xff" * 52),
    ]
    result = play(car, [*frames, jail.ended(SECOND)])
    assert result.violation is None
    assert result.command_count == 0
    assert [note.code for note in result.notes] == ["unreadable_message"]


def test_resting_costs_no_steps_and_few_samples(car: Car) -> None:
    frames = [jail.node(), jail.driver()]
    for start in (0, 50):
        frames += [
            jail.publish(2, start * SECOND, jail.twist(1.0)),
            jail.publish(2, (start + 1) * SECOND, jail.twist()),
        ]
    result = play(car, [*frames, jail.ended(59 * SECOND)])
    assert result.sim_steps < 700
    path = result.trajectory
    gaps = np.flatnonzero(np.diff(path.t_ns) > SECOND // 60 + 1)
    assert len(gaps) == 2
    for gap in gaps:
        assert path.x_m[gap] == path.x_m[gap + 1]
        assert path.v_mps[gap] == path.v_mps[gap + 1] == 0.0
    assert path.end_ns == 59 * SECOND
