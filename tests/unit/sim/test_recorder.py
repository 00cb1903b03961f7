import math

import numpy as np

from grader.sim.recorder import MAX_CONTACTS, Recorder

ORIGIN = (0.0, 0.0, 0.0)


def test_the_heading_is_unwrapped() -> None:
    recorder = Recorder()
    angles = [0.5 * k for k in range(40)]
    for t_ns, angle in enumerate(angles):
        recorder.sample(t_ns, (0.0, 0.0, math.remainder(angle, math.tau)), 0.0, 0.0)
    assert np.allclose(recorder.finish(0).heading_rad, angles)


def test_an_instant_is_sampled_once() -> None:
    recorder = Recorder()
    recorder.sample(3, ORIGIN, 1.0, 0.0)
    recorder.sample(3, ORIGIN, 2.0, 0.0)
    path = recorder.finish(0)
    assert list(path.v_mps) == [1.0]
    assert path.end_ns == path.t_ns[-1] == 3


def test_two_jumps_between_two_updates_are_one() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    recorder.jump(0, (1.0, 0.0, 0.0), 0.0, 0.0)
    recorder.sample(0, (1.0, 0.0, 0.0), 0.0, 0.0)
    recorder.jump(0, (2.0, 0.0, 0.0), 0.0, 0.0)
    recorder.sample(4, (2.0, 0.0, 0.0), 0.0, 0.0)
    path = recorder.finish(9)
    assert list(path.x_m) == [0.0, 2.0, 2.0]
    assert list(path.t_ns) == [0, 1, 4]
    assert path.jumps == (1,)


def test_the_last_command_of_an_update_is_kept() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for update, v in ((1, 1.0), (1, 2.0), (2, 3.0)):
        recorder.command({update: update}, v, 0.0)
    assert [command.v_mps for command in recorder.finish(0).commands] == [2.0, 3.0]


def test_contacts_that_follow_each_other_are_one() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for start_ns in (10, 11, 12, 20):
        recorder.contact(start_ns, start_ns + 1, "left")
    recorder.contact(11, 12, "top")
    found = [(c.wall, c.start_ns, c.end_ns) for c in recorder.finish(0).contacts]
    assert found == [
        ("left", 10, 13),
        ("top", 11, 12),
        ("left", 20, 21),
    ]


def test_contacts_are_bounded() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for start_ns in range(0, 4 * MAX_CONTACTS, 2):
        recorder.contact(start_ns, start_ns + 1, "left")
    assert len(recorder.finish(0).contacts) == MAX_CONTACTS
