"""A trajectory as JSON: columns of numbers, rounded so that files stay small and digests stable."""

import json
from dataclasses import asdict

import numpy as np

from grader.contracts.trajectory import Command, Contact, Floats, Trajectory

DECIMALS = 6
_FLOAT_COLUMNS = ("x_m", "y_m", "heading_rad", "v_mps", "w_radps")


def encode(trajectory: Trajectory) -> bytes:
    """Return canonical JSON (metres, radians and seconds rounded to 1e-6; times in whole nanoseconds)."""
    columns: dict[str, object] = {"t_ns": trajectory.t_ns.tolist()}
    for name in _FLOAT_COLUMNS:
        columns[name] = _rounded(getattr(trajectory, name))
    document = {
        **columns,
        "end_ns": trajectory.end_ns,
        "jumps": list(trajectory.jumps),
        "contacts": [asdict(contact) for contact in trajectory.contacts],
        "commands": [
            [t_ns, round(v_mps, DECIMALS), round(w_radps, DECIMALS)]
            for t_ns, v_mps, w_radps in trajectory.commands
        ],
    }
    return json.dumps(document, separators=(",", ":"), allow_nan=False).encode()


def decode(data: bytes) -> Trajectory:
    """Return the trajectory that `encode` wrote. Only for bytes written by the grader itself."""
    document = json.loads(data)
    floats = {name: np.array(document[name], dtype=np.float64) for name in _FLOAT_COLUMNS}
    return Trajectory(
        t_ns=np.array(document["t_ns"], dtype=np.int64),
        end_ns=document["end_ns"],
        jumps=tuple(document["jumps"]),
        contacts=tuple(Contact(**contact) for contact in document["contacts"]),
        commands=tuple(Command(*command) for command in document["commands"]),
        **floats,
    )


def _rounded(column: Floats) -> list[float]:
    # adding 0.0 turns -0.0 into 0.0, which would otherwise make two digests of one motion
    rounded: list[float] = (np.round(column, DECIMALS) + 0.0).tolist()
    return rounded
