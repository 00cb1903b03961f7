"""A stored trajectory is written as `json` writes it, byte for byte, whatever encoder does it."""

import json

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from grader.contracts.trajectory import Command, Trajectory, decode_trajectory, encode_trajectory, recorded

_NUMBERS = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300) | st.integers(
    -(10**7), 10**7
).map(lambda millionths: millionths / 1e6)


def _driven(values: list[float]) -> Trajectory:
    numbers = np.array(values, dtype=np.float64)
    commands = tuple(Command(number, value, -value) for number, value in enumerate(values))
    return Trajectory(
        t_ns=np.arange(len(values), dtype=np.int64) * 16_000_000,
        **dict.fromkeys(("x_m", "y_m", "heading_rad", "v_mps", "w_radps"), numbers),
        end_ns=10**12,
        commands=commands,
    )


@given(values=st.lists(_NUMBERS, min_size=1, max_size=20))
@example(values=[1e-6, 9.9e-5, 1e-4, 0.12345, -0.0])
@example(values=[10.000012, 1e16, -1e22])
def test_numbers_are_written_as_python_writes_them(values: list[float]) -> None:
    written = encode_trajectory(recorded(_driven(values)))

    assert written == json.dumps(json.loads(written), separators=(",", ":")).encode()
    assert encode_trajectory(decode_trajectory(written)) == written


@pytest.mark.parametrize("broken", [float("nan"), float("inf")])
def test_what_is_no_number_is_refused(broken: float) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        encode_trajectory(recorded(_driven([0.5, broken])))
