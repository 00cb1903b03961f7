import math

import numpy as np

from grader.contracts.trajectory import Command
from grader.sim.recorder import MAX_CONTACTS, Recorder
from grader.sim.timeline import step_time_ns

ORIGIN = (0.0, 0.0, 0.0)


def test_the_heading_is_unwrapped() -> None:
    recorder = Recorder()
    angles = [0.5 * k for k in range(40)]
    for step, angle in enumerate(angles):
        recorder.sample(step, (0.0, 0.0, math.remainder(angle, math.tau)), 0.0, 0.0)
    assert np.allclose(recorder.finish(0).heading_rad, angles)


def test_a_step_is_sampled_once() -> None:
    recorder = Recorder()
    recorder.sample(3, ORIGIN, 1.0, 0.0)
    recorder.sample(3, ORIGIN, 2.0, 0.0)
    path = recorder.finish(0)
    assert list(path.v_mps) == [1.0]
    assert path.end_ns == path.t_ns[-1] == step_time_ns(3)


def test_two_jumps_in_one_step_are_one() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    recorder.jump(0, (1.0, 0.0, 0.0), 0.0, 0.0)
    recorder.sample(0, (1.0, 0.0, 0.0), 0.0, 0.0)
    recorder.jump(0, (2.0, 0.0, 0.0), 0.0, 0.0)
    recorder.sample(4, (2.0, 0.0, 0.0), 0.0, 0.0)
    path = recorder.finish(9)
    assert list(path.x_m) == [0.0, 2.0, 2.0]
    assert list(path.t_ns) == [0, 1, step_time_ns(4)]
    assert path.jumps == (1,)


def test_the_last_command_of_a_step_is_kept() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for step, v in ((1, 1.0), (1, 2.0), (2, 3.0)):
        recorder.command(step, Command(t_ns=step, v_mps=v, w_radps=0.0))
    assert [command.v_mps for command in recorder.finish(0).commands] == [2.0, 3.0]


def test_contacts_of_following_steps_are_one() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for step in (10, 11, 12, 20):
        recorder.contact(step, "left")
    recorder.contact(11, "top")
    found = [(c.wall, c.start_ns, c.end_ns) for c in recorder.finish(0).contacts]
    assert found == [
        ("left", step_time_ns(10), step_time_ns(12)),
        ("top", step_time_ns(11), step_time_ns(11)),
        ("left", step_time_ns(20), step_time_ns(20)),
    ]


def test_contacts_are_bounded() -> None:
    recorder = Recorder()
    recorder.sample(0, ORIGIN, 0.0, 0.0)
    for step in range(0, 4 * MAX_CONTACTS, 2):
        recorder.contact(step, "left")
    assert len(recorder.finish(0).contacts) == MAX_CONTACTS
