"""Every recorded script, run here, moves the turtle as on the real turtlesim, or is named with the reason."""

import json
import re
from functools import cache

import numpy as np
import pytest

from grader.contracts.grading import Grader
from grader.sim.turtle import Inbox
from tests.real.motion import EXPLAINED, Driven, differences, drive, of_real
from tests.real.recordings import FOLDER, Poses, Recording, ids, recording
from tests.rows import slow_but

MOVING = [name for name in ids() if recording(name).poses is not None]
HOLD_S = 1.0


@cache
def real(name: str) -> Driven:
    return of_real(recording(name))


def twins(name: str) -> list[Driven]:
    return [real(other) for other in MOVING if other != name and recording(other).of == recording(name).of]


@pytest.mark.parametrize("name", slow_but(24, MOVING))
def test_a_recorded_script_moves_the_turtle_as_it_did(grader: Grader, name: str) -> None:
    ours = drive(grader, recording(name), real(name))
    found = differences(ours, real(name), twins(name))
    assert bool(found) == (recording(name).of in EXPLAINED), found


@pytest.mark.parametrize("name", ["t07_burst", "t07_burst__again", "t07_burst__fastdds", "t08_lesson"])
def test_a_burst_is_obeyed_one_command_an_update(grader: Grader, name: str) -> None:
    assert not differences(drive(grader, recording(name), real(name)), real(name), twins(name))


def test_documents_state_what_this_comparison_says() -> None:
    text = re.sub(r"\s+", " ", (FOLDER.parents[1] / "docs" / "fidelity.md").read_text("utf-8"))
    differ = sum(recording(name).of in EXPLAINED for name in MOVING)
    assert f"{len(MOVING)} recordings of a moving turtle: {len(MOVING) - differ} are equal" in text
    assert f"the other {differ}," in text
    for name in EXPLAINED:
        assert f"`{name}`" in text


@pytest.mark.parametrize(("name", "share"), [("t12_model", 0.98), ("t12_model__fastdds", 0.995)])
def test_the_law(name: str, share: float) -> None:
    """Commands at random, at random times: ours takes at each recorded update what the real turtlesim took."""
    one = recording(name)
    assert one.poses is not None
    commands = _commands(one)
    fits = [_agreement(one.poses, commands, late_s) for late_s in np.arange(0.0, 0.2, 0.002)]
    assert max(fits) >= share


def _commands(one: Recording) -> list[tuple[float, float, float]]:
    """Return what the script printed: when it published what, in seconds from the first."""
    (printed,) = (text for _, _, text in one.lines if text.startswith("[["))
    commands = [(float(t), float(v), float(w)) for t, v, w in json.loads(printed)]
    return [(t - commands[0][0], v, w) for t, v, w in commands]


def _agreement(poses: Poses, commands: list[tuple[float, float, float]], late_s: float) -> float:
    """Return the share of updates that have the recorded speeds, if the first command came at `late_s`."""
    inbox, v, w, taken_s, agree, coming = Inbox(), 0.0, 0.0, -HOLD_S, 0, 0
    for update, t_s in enumerate(poses.t_s):
        while coming < len(commands) and poses.t_s[0] + late_s + commands[coming][0] < t_s:
            inbox.add(update, *commands[coming][1:])
            coming += 1
        if inbox.due <= update:
            _, v, w = inbox.take()
            taken_s = t_s
        if t_s - taken_s > HOLD_S:
            v = w = 0.0
        agree += abs(abs(v) - poses.v_mps[update]) < 1e-4 and abs(w - poses.w_radps[update]) < 1e-4
    return agree / len(poses.t_s)
